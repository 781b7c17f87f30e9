"""Self-contact as a step sees it: who may touch, whether somebody could have passed through, how long to step."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.physics.contact import search
from solver.physics.contact.forces import Touch
from solver.physics.contact.law import Law
from solver.physics.contact.links import links_meet, links_reach
from solver.physics.contact.points import Points, contact_points, place_points
from solver.physics.contact.recipe import IN_MOTION, NOTHING, Foreseen, Hardness, held, spaced
from solver.physics.contact.search import Pairs
from solver.physics.contact.whole import carry_as_a_whole, velocity_as_a_whole
from solver.scene.contact import Contact
from solver.scene.rod import Rod

SKIN = (0.05, 0.75, 4.0)
"""In reaches: how far each point may go until the next search, at least; as far as the fastest will; and where it is
itself so fast, at the most."""
FORESEEN, FORESEEN_ALONE = 3.75, 20.0
"""Steps for which a point may go on within what a search has looked at; and where nobody is near."""
FARTHEST = 2.5
"""In reaches: how near the rod has to be to itself for a search to begin."""
BENT = 0.6
"""Part of the harmless bending that arcs may have which a search leaves out."""
LARGEST_PASSAGE = 0.35
"""Part of its distance that a pair may move in a step: too little to leap from where the force is weak to where the
aperture hides it (points nearer to each other than they are spaced see each other along the rod)."""
NOT_SHORT = 4.0
"""Steps that may follow within what the last search has looked at, from which on nobody asks how the rod moves as a
whole."""
LARGEST_SHIFT = 0.4
"""Part of its slack that a point may go in a step at its present speed; 0.5 is left before each step."""
TIME_TO_TOUCH = 0.2
"""Part of the time to closure, gap / closing speed, that the next step may take; a gap below half the distance counts
as that much, for what is held by a stiff force does not close at its speed."""

NO_LAW = Law.of(Contact(0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0), 1.0)


class SelfContact:
    """The contact of one rod through its run; without `contact` it proves itself absent and costs nothing.

    It is told the rod's total bending int |kappa_bending| ds (rad), and the nodes' positions `r` and velocities (n, 3),
    lab. `stages`: at how many times within a step a method evaluates the forces; `ends` and `hardness`: for contact
    without constants.
    """

    def __init__(self, contact: Contact | None, rod: Rod, s: Array, stages: int, ends: Foreseen = NOTHING,
                 hardness: Hardness = IN_MOTION) -> None:  # fmt: skip
        self.present = contact is not None
        """Whether the scene has contact at all."""
        self._nodes, self._stages, self._interval = len(s), stages, float(s[1] - s[0])
        points, self._law = _points_and_law(contact, rod, s, ends, hardness) if contact else (Points.none(), NO_LAW)
        # pairs that press, and those whose links may meet
        self._reach = max(self._law.cutoff, links_reach(points))
        self._farthest = FARTHEST * self._reach
        distances = (self._farthest, self._reach, self._law.cutoff)
        self._not_to_be_searched, self._not_to_be_checked, self._without_a_gap = (
            search.harmless_bending(distance, self._law) if contact else inf for distance in distances
        )
        self._slack, self._checked = 0.0, np.zeros((len(s), 3))
        """How far (m) all points may go since the last search where nobody is near, else 0; and where the nodes were
        then. A point goes `_share` times as far as they do, at the most."""
        self._share = float(np.abs(points.weights).sum(axis=1).max())
        self.rest, self._points_at_rest = np.zeros((len(s), 3)), np.zeros_like(points.p)
        """Velocities of nodes that do not move."""
        self._whole = np.zeros((len(s), 3)), np.zeros_like(points.p)
        """Where nodes and points would be, or how fast, had the rod moved as a whole: see `whole`."""
        self._dt = 0.0
        """The step under way (s)."""
        self._skip, self._straight = self._law.skip, 0.0
        """The arc (m) up to which the last search has left out pairs; and that in intervals, as its bending has to stay
        harmless for that; none where it is the law's own."""
        self._looked = False
        self.placed = 0
        """Points that the last step had to place, see `solver.methods.cost`."""
        self._make_room(points, 1024 if contact else 1)
        self.step_limit = inf
        """The longest next step (s)."""

    @property
    def touching(self) -> bool:
        """Whether there are pairs that may press: as `forces.touching`, without unpacking all arrays for a kernel."""
        return self._looked and bool(self.touch.pairs.counts[0] > 0)

    @property
    def pressing(self) -> int:
        """Number of pairs that press on each other."""
        return int(self.touch.pressing.many[-1]) if self.touching else 0

    def prepare(self, bending: float, r: Array, velocity: Array, dt: float, anew: bool = False) -> None:
        """Before a step of dt (s) from a state: make the list of pairs good for it; `anew`: also if it is yet."""
        self.placed, self._dt = 0, dt
        if bending < self._not_to_be_searched:
            if self._looked:
                self.touch.pairs.counts[:] = 0
                self._looked, self._slack, self._straight = False, 0.0, 0.0
            return
        bent = anew or self._is_bent(r, 0.5 * (1.0 + BENT))
        if not bent and self._strayed(r) < 0.5 * self._slack:
            return
        points = self._placed(r, velocity)
        if bent or not self._looked or self._used(r) > 0.5:
            self._checked[:] = r
            self._search(velocity, dt)
        points.start[:] = points.p

    def refusal(self, bending: float, nodes: Callable[[], tuple[Array, Array]]) -> str:
        """After a step to a trial state: why it cannot be trusted, or nothing. `nodes` places and moves them."""
        self.step_limit = inf
        if bending < self._not_to_be_checked:
            return ""
        r, velocity = nodes()
        if self._is_bent(r, 1.0):
            return "the rod bent more than the contact search foresaw"
        if self._strayed(r) < self._slack:
            self.step_limit = self._until_used(lambda at: self._share * search.largest_displacement(velocity, at[0])
                                               / self._slack, r, velocity)  # fmt: skip
            return ""
        points, pairs = self._placed(r, velocity), self.touch.pairs
        if not self._looked:
            near = search.smallest_distance(points, self._law.skip, self._farthest, 0.0) <= self._reach
            return "the rod came near itself within one step" if near else ""
        if self._used(r) > 1.0:
            return "the rod moved farther than the contact search looked"
        approach, time_to_touch = approaches(points, pairs)
        until_used = self._until_used(lambda at: search.used(points.w, at[1], points.slack), r, velocity)
        self.step_limit = min(TIME_TO_TOUCH * time_to_touch, until_used)
        if approach > LARGEST_PASSAGE:
            return "two parts of the rod could have passed through each other"
        if links_meet(points, pairs):
            return "two parts of the rod slipped into each other between contact points"
        return ""

    def _strayed(self, r: Array) -> float:
        """How far (m) a point has gone since the last search, where nobody was near: from where it was, or from where
        it would be if the rod had moved as a whole."""
        far = self._share * search.largest_displacement(r, self._checked)
        if not 0.5 * self._slack <= far or self._slack == 0.0:
            return far
        none = self._points_at_rest[:0]
        carry_as_a_whole(self._checked, r, self._whole[0], none, none)
        return min(far, self._share * search.largest_displacement(r, self._whole[0]))

    def _used(self, r: Array) -> float:
        """The largest part of its slack that a point, which is placed, has used up, likewise."""
        points = self.touch.points
        part = search.used(points.p, points.checked, points.slack)
        if part <= 0.5:
            return part
        carry_as_a_whole(self._checked, r, self._whole[0], points.checked, self._whole[1])
        return min(part, search.used(points.p, self._whole[1], points.slack))

    def _until_used(self, part: Callable[[tuple[Array, Array]], float], r: Array, velocity: Array) -> float:
        """How long (s) a step may be, of which `part` says how much of the slack is used up in a second, beside given
        velocities of nodes and points; where that is short, beside those of the rod as a whole."""
        used = part((self.rest, self._points_at_rest))
        if used * NOT_SHORT * self._dt > LARGEST_SHIFT:
            velocity_as_a_whole(r, velocity, self._whole[0], self.touch.points.p, self._whole[1])
            used = min(used, part(self._whole))
        return LARGEST_SHIFT / used if used > 0.0 else inf

    def _placed(self, r: Array, velocity: Array) -> Points:
        """The points, on a rod with nodes r that move at `velocity`."""
        self.placed = len(self.touch.points.p)
        place_points(self.touch.points, r, velocity)
        return self.touch.points

    def _is_bent(self, r: Array, part: float) -> bool:
        """Whether an arc that the last search has left out bends by more than a part of what is harmless."""
        return self._straight > 0.0 and search.most_bent(r, self._straight) > part * self._not_to_be_checked

    def smallest_gap(self, bending: float, r: Array) -> float:
        """Smallest surface-to-surface distance (m) of points more than the skip apart; NaN if contact is ruled out."""
        if bending < self._without_a_gap:
            return nan
        points = self.touch.points
        place_points(points, r, self.rest)
        gap = search.smallest_distance(points, self._law.skip, inf, 0.5)
        return gap if gap < inf else nan

    def power(self) -> Array:
        """Power (stages, 2) in W stored in contact, and dissipated by it, at the times of the last evaluation."""
        return self.touch.pressing.power if self.touching else np.zeros((self._stages, 2))

    def compile(self) -> None:
        """Have every kernel compiled that a run in contact needs."""
        points = self.touch.points
        place_points(points, self.rest, self.rest)
        self._search(self.rest, 0.0)
        points, pairs = self.touch.points, self.touch.pairs
        carry_as_a_whole(self._checked, self.rest, self._whole[0], points.checked, self._whole[1])
        search.smallest_distance(points, self._law.skip, inf, 0.5)
        approaches(points, pairs), links_meet(points, pairs)
        search.used(points.p, points.checked, points.slack), search.most_bent(self._checked, 1.0)

    def _search(self, velocity: Array, dt: float) -> None:
        """List the pairs as far as some steps of dt (s) reach; where there are none, know how far the nearest are."""
        points, reach = self.touch.points, self._reach
        points.checked[:] = points.p
        self._looked = True
        self._leave_out()
        skip = self._skip
        self._slack = 0.0
        velocity_as_a_whole(self._checked, velocity, self._whole[0], points.p, self._whole[1])
        fastest = search.largest_displacement(points.w, self._whole[1])
        least = min(max(FORESEEN * fastest * dt, SKIN[0] * reach), SKIN[1] * reach)
        search.foresee(points.w, self._whole[1], points.slack, FORESEEN * dt, least, SKIN[2] * reach)
        search.find_pairs(points, skip, reach, self.touch.pairs)
        if self.touch.pairs.counts[1] > 0:
            self._make_room(points, 2 * int(self.touch.pairs.counts.sum()))
            search.find_pairs(points, skip, reach, self.touch.pairs)
        if self.touch.pairs.counts[0] == 0:
            enough = max(2.0 * self._farthest, reach + 2.0 * FORESEEN_ALONE * fastest * dt)
            slack = 0.5 * (search.smallest_distance(points, skip, enough, 0.0) - reach)
            self._slack = slack if slack >= points.slack.max() else 0.0

    def _leave_out(self) -> None:
        """See which arcs bend so little that their ends cannot be near. (Around a ring they are not looked at.)"""
        straight = search.straight_arc(self._checked, BENT * self._not_to_be_checked)
        arc = straight * self._interval
        further = arc > self._law.skip and self.touch.points.closing == inf
        self._skip, self._straight = (arc, straight) if further else (self._law.skip, 0.0)

    def _make_room(self, points: Points, capacity: int) -> None:
        self.touch = Touch.empty(self.present, self._law, points, self._nodes, self._stages, capacity)


def _points_and_law(contact: Contact, rod: Rod, s: Array, ends: Foreseen,
                    hardness: Hardness) -> tuple[Points, Law]:  # fmt: skip
    if not contact.automatic:
        points = contact_points(contact, rod, s, ends.closing)
        return points, Law.of(contact, points.spacing)
    contact = spaced(contact, rod, hardness)
    points = contact_points(contact, rod, s, ends.closing)
    law = held(rod, ends, np.linspace(0.0, float(s[-1]), len(points.p)), hardness)
    return points._replace(mass=law.strength), Law.by_itself(contact, points.spacing, law.relaxation, hardness.pole)


@kernel
def approaches(points: Points, pairs: Pairs) -> tuple[float, float]:
    """The largest change of a separation relative to the distance before; the shortest time (s) to closure."""
    largest, shortest = 0.0, np.inf
    for pair in range(pairs.counts[0]):
        a, b = pairs.first[pair], pairs.second[pair]
        change, before, square, closing = 0.0, 0.0, 0.0, 0.0
        for k in range(3):
            now = points.p[a, k] - points.p[b, k]
            then = points.start[a, k] - points.start[b, k]
            change += (now - then) ** 2
            before += then * then
            square += now * now
            closing -= now * (points.w[a, k] - points.w[b, k])
        largest = max(largest, change / before)
        if closing > 0.0:
            d = np.sqrt(square)
            gap = max(d - 0.25 * (points.diameter[a] + points.diameter[b]), 0.5 * d)
            shortest = min(shortest, gap * d / closing)
    return np.sqrt(largest), shortest
