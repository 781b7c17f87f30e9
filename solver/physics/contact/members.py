"""The points and nodes that take part in some pairs, each listed once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import inlined, inner
from solver.physics.contact.points import REACH, Points


class Members(NamedTuple):
    """`counts` (2,): points and nodes that take part; `points` (M,) and `nodes` (n,) lists of them; `taken` (M,)
    whether a point is listed; `slot` (n,) a node's place in the list, or -1."""

    counts: Array
    points: Array
    nodes: Array
    taken: Array
    slot: Array

    @classmethod
    def none(cls, points: int, nodes: int) -> Members:
        """Nobody, of so many points and nodes."""
        return cls(np.zeros(2, np.int64), np.zeros(points, np.int64), np.zeros(nodes, np.int64),
                   np.zeros(points, np.bool_), np.full(nodes, -1))  # fmt: skip


@inner
def dismiss(members: Members) -> None:
    """Empty the lists."""
    members.counts[:] = 0
    members.taken[:] = False
    members.slot[:] = -1


@inlined
def take_in(members: Members, points: Points, i: int) -> None:
    """List point i and the nodes that it hangs on, unless they are listed."""
    if not members.taken[i]:
        members.taken[i] = True
        members.points[members.counts[0]] = i
        members.counts[0] += 1
        for node in range(points.first[i], points.first[i] + REACH):
            if members.slot[node] < 0:
                members.slot[node] = members.counts[1]
                members.nodes[members.counts[1]] = node
                members.counts[1] += 1
