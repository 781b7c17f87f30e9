"""The staggered method for rods that turn about one axis: one angle a segment instead of a rotation."""
