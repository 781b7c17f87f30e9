"""A static analysis: the frames of a branch of equilibria."""

from __future__ import annotations

from math import inf, nan, pi

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import compile_apart
from solver.kernels.rotation import rotate_back
from solver.measures.frame import Fields, Frame, Statistics, complete
from solver.measures.ring import is_ring
from solver.measures.topology import writhe_of_rod
from solver.methods.space.segments.balances import Motion
from solver.methods.space.segments.energies import energies_at, twist
from solver.methods.space.segments.fields import bending_at_nodes, orientations_at_nodes
from solver.methods.space.segments.layers import Layers
from solver.outcome import Outcome, RunFailed
from solver.physics.axial import axial_stiffness, largest_strain
from solver.physics.loads.solids import deepest_within
from solver.physics.section import Beside
from solver.physics.seed import size_of_seed
from solver.run.linking import LinkingNumber
from solver.run.run import Run
from solver.run.settling import settled, turned
from solver.run.watch import Watch
from solver.scene.contact import Contact
from solver.scene.ends import End
from solver.scene.initial import Initial
from solver.scene.numerics import Numerics
from solver.scene.rod import Rod
from solver.scene.scene import Scene
from solver.statics.ends import check_place
from solver.statics.equations import Equations
from solver.statics.first_forces import first_forces
from solver.statics.path import MOST_STEPS, Path
from solver.statics.point import Point
from solver.statics.stability import negative_modes, neutral_modes

WAYS = ("held", "settled")
"""In which to let go of the initial shape, the one to try first before the other: where the rod is held as it lies, or
where it has come to rest in motion, see `solver.run.settling`."""
PATIENCE = 200
"""Steps after which another one is tried."""
WIDEST_TURN = 0.9 * pi
"""Rotation (rad) within an interval that a step must not reach: beyond pi it would be told from the other side, and a
turn of a twisted rod be lost. No step is as long as what is left to pi and beyond."""
FAR_BACK = 1.0
"""And by how much more than at first the shape may be held: a branch that leads farther hardly ever comes back."""


ITERATION, OVERHEAD, PRESSED, COUPLED = 16.0, 60, 4.0, 0.4
"""Microseconds of an iteration for each interval, and for OVERHEAD besides, with all that goes with it; of that how
many times more where strands press on each other; and what the square of its intervals adds there, for all rotations
are counted together."""


class Equilibria(Run):
    """A branch of equilibria. Raises `RunFailed` where it cannot be followed.

    First what holds the initial shape is let go at t = 0, in the first of WAYS that leads to a stable equilibrium, or
    else to that with the fewest directions of falling energy; then the schedules go on. A frame's `t` is how far their
    time has travelled along the branch, to and fro; its `parameter` is their time itself.
    """

    def __init__(self, scene: Scene, statistics: Statistics | None = None) -> None:
        super().__init__(scene, statistics)
        check_place(scene)
        compile_apart("statics", "from solver.run.equilibria import exercise; exercise()")
        self.remarks.axial_stiffness = axial_stiffness(scene)
        self.remarks.buckling_seed = size_of_seed(scene)
        self._ring = is_ring(scene)
        self._watch = Watch(self.remarks, scene.contact is not None, self._ring)
        self._falling: list[float] = []
        """Directions of falling energy where each of the WAYS led; inf where it led nowhere."""
        self._loose = False
        """Whether the rod has yet to be turned by its first loads."""
        self._begin(0)

    def _begin(self, way: int) -> None:
        """Lay the rod down, held in one of the WAYS, by its index."""
        self._way, self._equations, self._linking = way, Equations(self._scene), LinkingNumber()
        elastic = self._equations.chain.elastic
        self._layers = Layers.of(self._scene, self.s)
        self._beside = Beside.steps(self._scene.rod, self.s, elastic.K, elastic.kappa0 - self._equations.offset)
        start = self._equations.start  # from whose shape the turns are counted
        self._equations.residual(start)
        self._follow_ends(start)
        self._linking.of(0.0, self._twist(start), self._writhe(self._fields(start)))
        if WAYS[way] == "settled":
            self._settle()
        else:
            self._equations.hold(first_forces(self._equations), turning=True)
        self._path = Path(self._equations, PATIENCE if way + 1 < len(WAYS) else MOST_STEPS)
        self._follow_ends(self._path.point)

    def _settle(self) -> None:
        """Hold the rod where it comes to rest in motion; if it does not, where it lies."""
        try:
            rest = settled(self._equations, self._scene)
        except RunFailed:
            return
        self._equations.begin(rest.point, rest.energy_contact)
        self._equations.hold(rest.point.F, turning=True)
        self.statistics.newton_iterations += round(rest.work / self.counted(0, 1))

    @property
    def s(self) -> Array:
        """Arclengths of the nodes (n,), m."""
        return self._equations.s

    @property
    def pressing(self) -> int:
        """Number of pairs of points that press on each other."""
        return self._equations.contact.pressing

    def counted(self, _steps: int, iterations: int) -> float:
        """About how long (us) some iterations take with all that goes with them, as `solver.methods.cost` has it."""
        intervals = len(self.s) - 1
        nearby = ITERATION * (intervals + OVERHEAD)
        each = PRESSED * nearby + COUPLED * intervals**2 if self.pressing else nearby
        return iterations * each

    def warm(self) -> None:
        """Have every kernel compiled."""
        self._equations.linearise(self._equations.start)
        negative_modes(self._equations)

    def _first_frame(self) -> Frame | None:
        if not self._let_go():
            return None
        self._equations.let_go()
        self._path.begin(self._corners())
        try:
            self._path.advance(0.0)
        except RunFailed as failure:
            if failure.outcome is not Outcome.SINGULAR_SYSTEM or not all(end.stays for end in self._equations.ends):
                raise
            self._loose = True
        return self._frame(0.0)

    def _let_go(self) -> bool:
        """Take a step in the way at hand; whether it has led to an equilibrium: a stable one, or the best of all."""
        try:
            reached = self._advance(1.0)
            if not (reached or self._leads_away()):
                return False
            falling = float(self._path.modes) if reached else inf
        except RunFailed:
            if self._way + 1 == len(WAYS) and min(self._falling) == inf:
                raise
            falling = inf
        if falling == 0.0 or len(self._falling) == len(WAYS):
            return True
        self._falling.append(falling)
        last = len(self._falling) == len(WAYS)
        best = max(way for way, fewest in enumerate(self._falling) if fewest == min(self._falling))
        following = best if last else len(self._falling)
        if following != self._way:
            self._begin(following)
            return False
        return True

    def _leads_away(self) -> bool:
        """Whether there is another way, and the branch of this one goes far back instead of letting go."""
        return self._way + 1 < len(WAYS) and self._path.point.q < -FAR_BACK

    def _turns(self, t: float) -> bool:
        """Turn the rod, which nothing holds against its first loads, to where it rests under those of t, if it has any
        by then; whether it has."""
        try:
            rest = turned(self._equations, self._scene, self._path.point, t)
        except RunFailed as failure:
            raise RunFailed(Outcome.SINGULAR_SYSTEM, t, self.statistics.steps, "its first loads turn it") from failure
        if rest is None:
            self._path.point.q = t / self._scene.t_end
            return False
        self._equations.begin(rest.point, rest.energy_contact)
        self._path.resume(rest.point)
        self.statistics.newton_iterations += round(rest.work / self.counted(0, 1))
        self._loose = False
        return True

    def _next_frame(self, output: float) -> Frame | None:
        if self._loose and not self._turns(output):
            self.t = output
            return self._frame(output)
        reached = self._advance(output / self._scene.t_end)
        self.t = self._path.travelled * self._scene.t_end
        return self._frame(output) if reached else None

    def _advance(self, stop: float) -> bool:
        path, statistics = self._path, self.statistics
        steps, failed, iterations = path.steps, path.failed, path.iterations
        reached = path.advance(stop)
        statistics.steps += path.steps - steps
        statistics.failed_steps += path.failed - failed
        statistics.newton_iterations += path.iterations - iterations
        turn = float(np.linalg.norm(self._equations.stages.bend[0], axis=1).max())
        if turn > WIDEST_TURN:
            raise RunFailed(Outcome.MESH_TOO_COARSE, self._equations.time(path.point.q), statistics.steps,
                            f"by {turn:.3g} rad within an interval")  # fmt: skip
        self._follow_ends(path.point)
        return reached

    def _corners(self) -> list[float]:
        """Values of q at which a schedule bends."""
        times = [t for end in self._equations.ends for t in end.corners()] + self._equations.applied.corners()
        return [t / self._scene.t_end for t in times]

    def _frame(self, t: float) -> Frame:
        """The frame of the point that the path has reached."""
        equations, path, point = self._equations, self._path, self._path.point
        equations.look_at(point)
        if equations.strain() > largest_strain(self._scene):
            detail = f"stretched or squeezed by a factor of {1.0 + equations.strain():.3g}"
            raise RunFailed(Outcome.ROD_STRETCHED, equations.time(point.q), self.statistics.steps, detail)
        fields = self._fields(point)
        held = [end.held[3:5] for end in equations.ends]
        unresolved_bending = self._layers.complete(fields, held, equations.time(point.q))
        self.remarks.rested(t, path.modes, equations.loads_turn())
        self.remarks.stretched(equations.strain(), float(self.s[-1]))
        self.remarks.sunk(deepest_within(self._scene, self.s, fields.r), t)
        stages = equations.stages
        motion = Motion(stages.r[0], stages.V[0], stages.A[0], stages.R[0], stages.omega[0])
        energy = energies_at(equations.chain, equations.loads, 0, stages.bend[0], stages.F[0], motion)
        energy = energy._replace(bending=energy.bending + unresolved_bending, kinetic=0.0, added_mass=0.0)
        Tw, Wr = self._twist(point), self._writhe(fields)
        frame = Frame(
            t=t, **vars(fields),
            **{f"energy_{name}": value for name, value in energy._asdict().items()},
            energy_contact=equations.contact.energy,
            work_ends=nan, work_loads=nan, dissipation=nan, energy_balance=nan,
            Tw=Tw, Wr=Wr, Lk=self._linking_number(equations.time(point.q), Tw, Wr),
            min_gap=equations.contact.smallest_gap(equations.bending(), equations.nodes()),
            contacts=equations.contact.pressing,
            dt=path.last_dq * self._scene.t_end, newton_iterations=path.last_iterations,
            parameter=equations.time(point.q), negative_modes=path.modes,
            neutral_modes=neutral_modes(equations, path.modes),
        )  # fmt: skip
        crossed = self._watch.see(frame)
        if crossed:
            raise RunFailed(Outcome.ROD_CROSSED_ITSELF, equations.time(point.q), self.statistics.steps, crossed)
        return complete(frame, self.s, self._scene)

    def _twist(self, point: Point) -> float:
        return float(twist(point.quaternion) / (2 * pi))

    def _writhe(self, fields: Fields) -> float:
        if not self._scene.topology:
            return nan
        return writhe_of_rod(fields.r, fields.orientation, self._ring)

    def _linking_number(self, t: float, Tw: float, Wr: float) -> float:
        """NaN where the ends' relative rotation is not prescribed."""
        turned = self._turned(t)
        return nan if turned is None else self._linking.of(turned, Tw, Wr)

    def _follow_ends(self, point: Point) -> None:
        """After each step of the path: what the ends' tangents have swept."""
        ends, turned = (self._scene.start, self._scene.end), self._turned(self._equations.time(point.q))
        if self._scene.topology and turned is not None and not all(end.holds_tangent() for end in ends):
            self._linking.follow(turned, point.quaternion)

    def _turned(self, t: float) -> float | None:
        """The rotation (rad) of the end about a3 relative to that of the start, if both are prescribed."""
        start, end = (end.spin(t) for end in self._equations.ends)
        return None if start is None or end is None else end - start

    def _fields(self, point: Point) -> Fields:
        """The state along the rod, at the nodes, of the point that was looked at last."""
        equations, rest = self._equations, np.zeros_like(point.F)
        stages, orientation = equations.stages, np.empty((len(self.s), 4))
        orientations_at_nodes(point.quaternion, orientation)
        kappa, q = stages.bend[0].copy(), stages.moment[0].copy()
        bending_at_nodes(equations.chain, kappa, q, stages.left[0], stages.right[0])
        return Fields(
            v=rest, omega=rest, f=rotate_back(orientation, point.F),
            kappa=self._beside.at_nodes(kappa - equations.offset, q), q=q,
            strain=stages.opening[0, 0] / equations.chain.span, r=equations.nodes(), orientation=orientation,
        )  # fmt: skip


def exercise() -> None:
    """Call every kernel of a static analysis, for a tiny scene."""
    rod, numerics = Rod.circular(1.0, 0.01, 1e7, 5e6, 1500.0), Numerics(intervals=4)
    scene = Scene(rod=rod, initial=Initial.straight(), start=End.clamp(), end=End.free(), t_end=1.0,
                  output_interval=1.0, numerics=numerics, contact=Contact(), analysis="static")  # fmt: skip
    analysis = Equilibria(scene)
    analysis.warm()
    analysis._equations.contact.compile()
    analysis._frame(0.0)
