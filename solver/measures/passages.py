"""What passed through what between two shapes of an open rod: the rod through itself, or through a ray at an end.

Tw + Wr - Lk of an open rod jumps by 2 when two of its parts pass through each other, and also when a loop hops over an
end, through the ray that continues the centreline there in the definition of its writhe. Wr is a sum over pairs:
of segments with segments, and of segments with rays. Each of the two sums is continuous but for jumps of 2 where one of
its own pairs meets. So the one that jumps on the way tells which it was.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.measures.frame import Fields
from solver.measures.topology import NO_RAYS, tangents_of_ends, writhe_shares

DIVISIONS = 8
"""How often the way is divided where a sum changes: what is smooth is by then far below a jump of 2."""
SPLIT = 0.47
"""Where it is divided: not in the middle, where what is symmetric would just touch."""
QUIET = 0.5
"""Turns by which both sums may change where nobody looks more closely."""


class Shape(NamedTuple):
    """A centreline: its vertices `r` (n, 3), m, and the tangents at its ends (2, 3), lab; NO_RAYS of a ring."""

    r: Array
    tangents: Array


def shape_of(fields: Fields) -> Shape:
    """The centreline of a state."""
    return Shape(fields.r, tangents_of_ends(fields.orientation))


def joined(shape: Shape) -> Shape:
    """The centreline, closed by a straight line."""
    return Shape(shape.r, NO_RAYS)


class Passages(NamedTuple):
    """How often the rod passed through itself, and how often a loop hopped over an end: with signs, that of the change
    of Tw + Wr - Lk."""

    crossings: int
    hops: int


def passages(before: Shape, after: Shape) -> Passages:
    """What happened on the straight way from one shape to the other.

    Two crossings of opposite sign may cancel, and are not told then.
    """
    return Passages(*_jumps(before, after, np.array(_shares(before)), np.array(_shares(after)), DIVISIONS))


def _shares(shape: Shape) -> tuple[float, float]:
    return writhe_shares(*shape)


def _jumps(before: Shape, after: Shape, first: Array, last: Array, divisions: int) -> tuple[int, int]:
    """The jumps of both sums, in twos, signed."""
    change = last - first
    if np.abs(change).max() < QUIET:
        return 0, 0
    if divisions == 0:
        return round(0.5 * change[0]), round(0.5 * change[1])
    here, there = 1.0 - SPLIT, SPLIT
    middle = Shape(here * before.r + there * after.r, here * before.tangents + there * after.tangents)
    if not np.linalg.norm(middle.tangents, axis=1).all():
        return round(0.5 * change[0]), round(0.5 * change[1])
    half = np.array(_shares(middle))
    early, late = _jumps(before, middle, first, half, divisions - 1), _jumps(middle, after, half, last, divisions - 1)
    return early[0] + late[0], early[1] + late[1]
