"""The staggered method: rigid segments joined at the nodes, Radau IIA in time. See `method.StaggeredMethod`."""
