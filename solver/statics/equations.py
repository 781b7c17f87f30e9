"""Equilibrium of the chain: what is left of its equations at a point, and how that changes.

Rows: moments, forces, and that neighbours stay joined, of which the forces between them are the multiplier. All is made
dimensionless by L and EJ. Balances and their tangents are the staggered method's own, at rest.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from solver.arrays import Array
from solver.methods.space.segments.balances import Driven, Tangents, balance_segments, segment_tangents
from solver.methods.space.segments.chain import Residuals, Stages
from solver.methods.space.segments.initial import chain_of, lay_out, loads_on_segments, segments_of
from solver.methods.space.segments.joints import total_bending
from solver.methods.space.segments.opening import add_levers
from solver.physics.axial import axial_compliance, stretch_of
from solver.physics.elasticity import can_stretch, mean_bending
from solver.physics.loads.registry import records_with_energy
from solver.scene.loads import have_moments
from solver.scene.scene import Scene
from solver.statics.contact import StaticContact
from solver.statics.ends import StaticEnd, Units
from solver.statics.point import BLOCK, FORCE, PSI, Point, X, lay_down
from solver.statics.solvers import CoupledSolver, Solver
from solver.statics.tangent import chain_blocks, crossing, node_moves, of_contact

SKEW = 1e-6
"""Part of the largest derivative of loads by place by which they may differ from those of a potential: differences."""
SOFTEST = 1e-8
"""Stiffness (in EJ/L, shared by all segments) given to every rotation in the iteration, which does not change what it
converges to: a rod that may spin freely about its own axis has one state, the nearest."""
BESIDE = 1e-6
"""By how much q changes, to and fro, in the difference that tells a slope."""
MOST_LOADED = 1e5
"""Force in EJ/L^2 above which a rod counts as loaded by so much: a long cable's tension says nothing of its twist."""


class Equations:
    """Residual and tangent of a scene's equilibrium."""

    def __init__(self, scene: Scene) -> None:
        N, length = scene.numerics.intervals, float(scene.rod.length)
        self.s, self.t_end = np.linspace(0.0, length, N + 1), scene.t_end
        section = segments_of(scene.rod, self.s)
        self.applied = loads_on_segments(scene, section, self.s, times=1)
        self.loads = self.applied.records
        self.chain = chain_of(scene.rod, section, self.applied.entrained, self.s)
        state, self.offset = lay_out(scene, self.chain, self.s)
        self.start = Point(state.quaternion.copy(), state.base[0].copy(), np.zeros((N + 1, 3)), 0.0)
        self.stages, self.tangents, self._stored = Stages.empty(N), Tangents.empty(N), Tangents.empty(N)
        self._driven, self._residuals = Driven.empty(N), Residuals.empty(N)
        lay_down(self.chain, state.quaternion, self.start.base, self.start.F, self.stages)
        self.stiffness = mean_bending(self.chain.elastic)
        self._units = Units(self.stiffness / length, self.stiffness / length**2, length)
        self.units = np.repeat([1.0, length, self._units.force], 3)
        self._rows = 1.0 / np.repeat(self._units, 3)
        self._moments = have_moments(*scene.points, *scene.distributed)
        self.compliance, self._stretches = 0.5 * axial_compliance(scene), can_stretch(scene.rod)
        places = self.start.base.copy(), self.tip()
        self.ends = [StaticEnd(end, side, state.quaternion[-side].copy(), places[side], scene.t_end, self._units,
                                self.compliance)
                     for side, end in enumerate((scene.start, scene.end))]  # fmt: skip
        self.contact = StaticContact(scene, self.s, self.nodes())
        self.contact.look_ahead(self.bending(), self.nodes(), self.contact.rest)
        self.hold()

    def hold(self, F: Array | None = None, turning: bool = False) -> None:
        """Begin with forces F (N + 1, 3), lab, in the rod, and hold it; `turning`: by forces that turn with it."""
        self.start.F[:] = 0.0 if F is None else F
        self._turning = turning
        self.letting_go, self._held = False, 0.0
        """Whether what holds the initial shape is taken away, as q goes from 0 to 1 at t = 0; how much is there."""
        self.holding = self.residual(self.start)
        """What holds the initial shape (N + 2, 9), dimensionless, lab; where it turns, with material forces on the
        segments, so that it does not press them along."""
        if turning:
            self.holding[1:-1, X] = _turned_by(self.stages.R[0].transpose(0, 2, 1), self.holding[1:-1, X])
        self.letting_go = True

    def begin(self, start: Point, energy: float) -> None:
        """Begin elsewhere: where contact stores `energy` (J)."""
        self.start = start
        lay_down(self.chain, start.quaternion, start.base, start.F, self.stages)
        self.contact.look_ahead(self.bending(), self.nodes(), self.contact.rest)
        self.contact.begin(self.nodes(), energy)

    def let_go(self) -> None:
        """Nothing holds the initial shape any more; q is now the schedules' time."""
        self.letting_go = False

    def time(self, q: float) -> float:
        """The schedules' time (s) at the parameter q."""
        return 0.0 if self.letting_go else q * self.t_end

    def loading(self) -> float:
        """The scale on which a stiffness or a force counts as none: the largest force in the rod in EJ/L^2, of the
        point evaluated last, between 1 and MOST_LOADED."""
        return float(np.clip(np.abs(self.stages.F[0]).max() / self._units.force, 1.0, MOST_LOADED))

    def tip(self) -> Array:
        """Where the end of the rod is (3,), of the point evaluated last."""
        lever = 0.5 * self.chain.h + self.stages.opening[0, 0, -1]
        return np.asarray(self.stages.r[0, -1] + lever * self.stages.R[0, -2, :, 2])

    def nodes(self) -> Array:
        """Where the nodes are (N + 1, 3), of the point evaluated last."""
        r, T = self.stages.r[0], self.stages.R[0, 1:-1, :, 2]
        half = 0.5 * self.stages.opening[0, 0, 1:, None]
        tips = r + 0.5 * self.chain.h * T + half * 0.5 * (T + np.vstack([T[1:], T[-1:]]))
        tips[-1] += half[-1] * T[-1]
        return np.vstack([self.stages.base[0, 0], tips])

    def bending(self) -> float:
        """The rod's total bending (rad), of the point evaluated last."""
        return float(total_bending(self.stages.bend[0]))

    def look_ahead(self, point: Point, guess: Point) -> None:
        """Before a step from a point to a guess: see who may come into contact."""
        if self.contact.present:
            lay_down(self.chain, guess.quaternion, guess.base, guess.F, self.stages)
            there = self.nodes()
            lay_down(self.chain, point.quaternion, point.base, point.F, self.stages)
            self.contact.look_ahead(self.bending(), self.nodes(), there - self.nodes())

    def keeps_apart(self, z: Array) -> bool:
        """Whether a displacement of the point evaluated last leaves strands that press on each other apart."""
        return not self.contact.pressing or self.contact.allowed(self.moved_nodes(z)) >= 1.0

    def keep(self) -> None:
        """Enter that a step was taken to the point evaluated last."""
        if self.contact.present:
            self.contact.keep(self.nodes())

    def turned(self, point: Point, after: Point) -> float:
        """By how much ends are driven to turn (rad) from a point to another, at the most."""
        t, later = self.time(point.q), self.time(after.q)
        return max(float(np.abs((end.values(later) - end.values(t)) * end.held)[3:].max()) for end in self.ends)

    def refusal(self) -> str:
        """Why contact does not let the point evaluated last be trusted, after a step, or nothing."""
        contact = self.contact
        return contact.refusal(self.bending(), lambda: (self.nodes(), contact.rest)) if contact.present else ""

    def residual(self, point: Point) -> Array:
        """What is left of the equations at a point (N + 2, 9), dimensionless."""
        lay_down(self.chain, point.quaternion, point.base, point.F, self.stages)
        if self.contact.present:
            self._driven.push[0] = self.contact.push(self.nodes())
        return self._left(point)

    def _left(self, point: Point) -> Array:
        """The same where the rod has been laid down."""
        t, stages, driven = self.time(point.q), self.stages, self._driven
        self.applied.set_time(t)
        balance_segments(self.chain, self.loads, driven, stages, self._residuals, 0)
        if self._stretches:
            add_levers(stages.R[0], point.F, stages.opening[0, 0], self._residuals.rotation[0])
        self.applied.check()
        left = np.zeros((len(point.quaternion), BLOCK))
        left[1:-1, PSI], left[1:-1, X] = self._residuals.rotation[0, 1:-1], self._residuals.translation[0]
        for side, end in enumerate(self.ends):
            s, quaternion, R = float(self.s[-1]) * side, point.quaternion[-side], stages.R[0, -side]
            dead, follower = self.applied.at_end(t, s, "lab"), self.applied.at_end(t, s, "material")
            place, inner = (self.tip(), stages.right[0, -1]) if side else (point.base, stages.left[0, 0])
            left[-side, PSI], left[-side, X] = end.left(t, quaternion, R, place, point.F[-side], inner, dead, follower)
            driven.dead[0, side], driven.values[0, side, :3] = dead, end.follower
        left *= self._rows
        self._held = 1.0 - point.q if self.letting_go else 0.0
        return left - self._held * self._what_holds() if self.letting_go else left

    def _what_holds(self) -> Array:
        """What holds the initial shape (N + 2, 9), dimensionless, lab, at the point evaluated last."""
        if not self._turning:
            return self.holding
        holds = self.holding.copy()
        holds[1:-1, X] = _turned_by(self.stages.R[0], self.holding[1:-1, X])
        return holds

    def slope(self, point: Point, ahead: float) -> Array:
        """How the residual changes with q beside the point evaluated last, at q + `ahead` (N + 2, 9)."""
        if self.letting_go:
            return self._what_holds()
        sides = [Point(point.quaternion, point.base, point.F, point.q + ahead + x) for x in (BESIDE, -BESIDE)]
        up, down = (self._left(side) for side in sides)
        return (up - down) / (2.0 * BESIDE)

    def strain(self) -> float:
        """The largest strain; or how far the ends are stretched, in rod lengths; of the point evaluated last."""
        if self._stretches:
            return stretch_of(self.stages.opening[0, 0] / self.chain.span)
        forces, tangents = self.stages.F[0, [0, -1]], self.stages.R[0, [0, -1], :, 2]
        return float(self.compliance * np.abs(np.sum(forces * tangents, axis=1)).sum() / self.s[-1])

    def loads_turn(self) -> bool:
        """Whether loads have no potential, of the point that was looked at last: what turns with the rod, a moment
        where it may turn about more than one axis (Ziegler, Principles of Structural Stability, 1968), or what depends
        on the place in a way that no energy does."""
        K = self.tangents.K
        skew = np.abs(K - np.swapaxes(K, 1, 2)).max() > SKEW * np.abs(K).max()
        turning = [end.follower.any() or (end.moment.any() and end.held[3:].sum() < 2) for end in self.ends]
        return bool(skew or self.tangents.E.any() or self._moments or any(turning))

    def look_at(self, point: Point) -> Array:
        """The residual (N + 2, 9) at a point, with `stages` and `tangents` there."""
        left = self.residual(point)
        segment_tangents(self.chain, self.loads, self._driven, self.stages, 0, self.tangents)
        return left

    def stiffness_of_loads(self) -> Array:
        """How the forces of those loads that store energy change with the places of the segments (N, 3, 3), of the
        point that was looked at last."""
        if not self.tangents.K.any():
            return np.asarray(self.tangents.K)
        segment_tangents(self.chain, records_with_energy(self.loads), self._driven, self.stages, 0, self._stored)
        return np.asarray(self._stored.K)

    def linearise(self, point: Point) -> tuple[Array, Solver | CoupledSolver]:
        """The residual (N + 2, 9) and the factored tangent at a point."""
        left = self.look_at(point)
        if self.contact.pressing:
            return left, CoupledSolver(self.blocks(), self._of_contact(), self.units)
        return left, Solver(self.blocks(), self.units)

    def _of_contact(self) -> csr_array:
        """What strands that press on each other add to the tangent, see `of_contact`."""
        carried = node_moves(self.stages.R[0], self.chain.h, self.units)
        return of_contact(*self.contact.stiffness(), carried, self._moves(), self._rows[0])

    def changed_by(self, moves: Array, blocks: tuple[Array, Array, Array]) -> Array:
        """What each of some displacements (k, N + 2, 9) makes of the residual (k, N + 2, 9), of the point that was
        looked at last, whose tangent has these `blocks`."""
        (D, lower, upper), z = blocks, (moves / self.units)[..., None]
        changed = D @ z
        changed[:, 1:] += lower[1:] @ z[:, :-1]
        changed[:, :-1] += upper[:-1] @ z[:, 1:]
        if self.contact.pressing:
            changed += (self._of_contact() @ z.reshape(len(z), -1).T).T.reshape(z.shape)
        return np.asarray(changed[..., 0])

    def moved_nodes(self, z: Array) -> Array:
        """How far a displacement z (N + 2, 9) moves the nodes (N + 1, 3), of the point evaluated last."""
        moves, z = self._moves(), z / self.units
        return np.asarray((moves[:, 0] @ z[:-1, :, None] + moves[:, 1] @ z[1:, :, None])[:, :, 0])

    def _moves(self) -> Array:
        """See `node_moves`: of the rod's own nodes."""
        opens = self.tangents.opens if self._stretches else None
        return node_moves(self.stages.R[0], self.chain.h, self.units, opens)

    def blocks(self) -> tuple[Array, Array, Array]:
        """Diagonal (N + 2, 9, 9) of the tangent, and the blocks before and behind it, dimensionless."""
        R, soft = self.stages.R[0], SOFTEST * self.stiffness * self.chain.h / self.s[-1] ** 2
        D, lower, upper = chain_blocks(self.tangents, R, self.chain.h, soft, self._stretches)
        if self.letting_go and self._turning:
            D[1:-1, X, PSI] += self._held * self._units.force * R[1:-1] @ crossing(self.holding[1:-1, X])
        D[0, FORCE, FORCE] = np.eye(3) * self.units[3] / self.units[6]
        for side, end in enumerate(self.ends):
            a = -side
            end.bind(D[a], lower[a], upper[a], R[a], self.stages.F[0, a])
        scale = self._rows[:, None] * self.units
        return D * scale, lower * scale, upper * scale


def _turned_by(R: Array, forces: Array) -> Array:
    """Those on segments (N, 3) by the rotations of all orientations (N + 2, 3, 3)."""
    return np.asarray((R[1:-1] @ forces[:, :, None])[:, :, 0])
