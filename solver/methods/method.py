"""What a method is to the simulation: a state of the rod, and steps that are tried and then taken."""

from __future__ import annotations

from math import inf, nan
from typing import NamedTuple, Protocol

import numpy as np

from solver.arrays import Array
from solver.measures.energies import Energies
from solver.measures.frame import Fields
from solver.measures.passages import Shape
from solver.methods.cost import Cost
from solver.physics.ends import DrivenEnd
from solver.physics.loads.applied import AppliedLoads
from solver.physics.section import Beside
from solver.scene.scene import Scene


class Ahead(NamedTuple):
    """What is yet to come, from what is shown to the end of the last step: the `energy` (4,) that flows, see
    `Method.take_step`, and by how much the start and the end are `twisted` (2,), rad about a3."""

    energy: Array
    twisted: tuple[float, float]


NOTHING_AHEAD = Ahead(np.zeros(4), (0.0, 0.0))


class Method(Protocol):
    """A discretization in space and time of one scene. Where an answer stands here, it is that of most.

    `s` (n,): arclengths of the nodes (m); `beside`: the nodes whose curvature is not that of `fields`; `start`, `end`:
    the driven ends; `applied`: the given loads; `shortest_step` (s): no shorter step is possible; `increment_order`:
    power of dt with which `relative_increment` falls, and `increment_tolerance` how large it may be unless told;
    `easy_iterations`: Newton iterations up to which a step may be followed by a longer one; `touches`: whether it takes
    scenes that can touch themselves; `cost`: of its steps, as runs to a tolerance count it; `unresolved_bending`: by
    how much (J) the bending energy of what `fields` showed last is more than that of the mesh: in layers.
    """

    s: Array
    beside: Beside
    start: DrivenEnd
    end: DrivenEnd
    applied: AppliedLoads
    shortest_step: float = 0.0
    increment_order: float
    increment_tolerance: float
    easy_iterations: int
    touches: bool
    cost: Cost
    unresolved_bending: float = 0.0

    @classmethod
    def of(cls, scene: Scene) -> Method | None:
        """The method for a scene; None where another one is to take it."""

    def try_step(self, t: float, dt: float, consistent: bool = False) -> tuple[int, int]:
        """Try to go from t to t + dt; how it ended (see `status`) and the Newton iterations.

        `consistent`: dt is tiny, and what is wanted is accelerations and forces.
        """

    def relative_increment(self, dt: float) -> float:
        """The trial's local error relative to its motion."""

    def strain(self) -> float:
        """By what part of its length an interval of the trial has stretched at the most: the exact rod cannot."""
        return 0.0

    def turn(self) -> float:
        """The largest rotation (rad) of the trial within an interval: from pi on it does not say how the rod lies."""

    def refusal(self) -> str:
        """Why contact does not let the trial be trusted, or nothing."""
        return ""

    def take_step(self, t: float, dt: float) -> Array:
        """Make the trial the state; return the energy (4,) in J that flowed in the step.

        From the ends, from the loads, dissipated, into contact.
        """

    def switch_ends(self, t: float) -> None:
        """Put in force the end conditions that hold from t on."""

    def step_limit(self) -> float:
        """The longest next step (s) that contact and loads allow."""
        return inf

    def next_blow(self) -> float:
        """In what time (s) the next step is to end, so that a part of the rod meets or leaves a solid between two."""
        return inf

    def look_back(self, ago: float) -> Ahead:
        """Show the rod as it was `ago` (s) before the end of the last step, until the next one is tried: as `fields`,
        `energies`, `twist`, `centreline` and `smallest_gap` see it. Say what came afterwards: nothing, where steps end
        at every frame."""
        return NOTHING_AHEAD

    @property
    def orientations(self) -> Array | None:
        """At the end of the last step, quaternions (., 4) of which the first and the last are the ends'; None where the
        rod stays in a plane or straight."""
        return None

    def fields(self) -> Fields:
        """The state along the rod."""

    def centreline(self) -> Shape:
        """The state's centreline, as it is until the next step."""

    def energies(self) -> Energies:
        """The energies of the state, but for contact."""

    def twist(self) -> float:
        """Tw of the state, in turns."""

    def smallest_gap(self) -> float:
        """Smallest surface-to-surface distance (m) of points more than the skip apart; NaN if contact is ruled out."""
        return nan

    def pressing(self) -> int:
        """Number of pairs of points that press on each other."""
        return 0

    def contact_points_placed(self) -> int:
        """Number of points of self-contact that the last step looked at."""
        return 0

    def compile(self) -> None:
        """Have every kernel compiled that a run may need."""
