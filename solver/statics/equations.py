"""Equilibrium of the chain: residual and tangent of one point, and the banded solve.

Unknown at block a = 0 ... N + 1: the rotation psi of orientation a, the displacement x (of the start, of segment a's
centre, of the end), and the force F at node a - 1. Rows: moments, forces, and that neighbours stay joined, of which F
is the multiplier; so where the loads have a potential the tangent is symmetric at equilibrium. All is made
dimensionless by L and EJ. Balances and their tangents are the staggered method's own, at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgbtrf, dgbtrs
from scipy.sparse import bsr_array, csr_array
from scipy.sparse.linalg import SuperLU, splu

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import kernel
from solver.kernels.rotation import matrices_of, relative_rotation, rotation_of, turn
from solver.methods.space.segments.balances import Driven, Tangents, balance_segments, segment_tangents
from solver.methods.space.segments.chain import Chain, Residuals, Stages
from solver.methods.space.segments.initial import chain_of, lay_out, loads_on_segments
from solver.methods.space.segments.joints import bend_joints, total_bending
from solver.methods.space.segments.motion import follow_segments
from solver.methods.space.segments.opening import add_levers, measure_openings, pull_joints, shift_segments
from solver.physics.axial import axial_compliance
from solver.physics.elasticity import can_stretch, mean_bending, stretches
from solver.physics.loads.registry import records_with_energy
from solver.scene.scene import Scene
from solver.statics.contact import StaticContact
from solver.statics.ends import StaticEnd

BLOCK, BAND = 9, 17
SKEW = 1e-6
"""Part of the largest derivative of loads by place by which they may differ from those of a potential: differences."""
SOFTEST = 1e-8
"""Stiffness (in EJ/L, shared by all segments) given to every rotation in the iteration, which does not change what it
converges to: a rod that may spin freely about its own axis has one state, the nearest."""
SOFTEST_PLACE = 1e-12
"""Likewise of the largest stiffness of loads by place, given to every place: a rod that may slide along a floor has one
state, the nearest."""
MOST_LOADED = 1e5
"""Force in EJ/L^2 above which a rod counts as loaded by so much: a long cable's tension says nothing of its twist."""
PSI, X, FORCE = slice(0, 3), slice(3, 6), slice(6, 9)


@dataclass
class Point:
    """A state at rest: `quaternion` (N + 2, 4), `base` (3,), `F` (N + 1, 3), lab; at the parameter `q` = t / t_end."""

    quaternion: Array
    base: Array
    F: Array
    q: float

    def moved(self, z: Array, dq: float) -> Point:
        """The point displaced by `z` (N + 2, 9), in units of rotation, place and force."""
        quaternion = np.empty_like(self.quaternion)
        _turn_all(self.quaternion, np.ascontiguousarray(z[:, PSI]), quaternion)
        return Point(quaternion, self.base + z[0, X], self.F + z[1:, FORCE], self.q + dq)


@kernel
def _turn_all(quaternion: Array, psi: Array, turned: Array) -> None:
    for a in range(len(psi)):
        turn(quaternion[a], psi[a], turned[a])


@kernel
def _lay_down(chain: Chain, quaternion: Array, base: Array, F: Array, stages: Stages) -> None:
    """Write rotations, forces, places and moments of stage 0; velocities and accelerations stay zero."""
    copy(quaternion, stages.quaternion[0])
    matrices_of(quaternion, stages.R[0])
    copy(base, stages.base[0, 0])
    follow_segments(stages.R[0], stages.omega[0], stages.alpha[0], stages.base[0], chain.h,
                    stages.r[0], stages.V[0], stages.A[0])  # fmt: skip
    bend_joints(chain, quaternion, stages.bend[0], stages.moment[0], stages.left[0], stages.right[0])
    copy(F, stages.F[0])
    if stretches(chain.elastic):
        pull_joints(chain, stages.R[0], F, stages.bend[0], stages.moment[0], stages.left[0], stages.right[0])
        measure_openings(chain, stages.R[0], F, stages.bend[0], stages.opening[0, 0])
        shift_segments(stages.R[0], stages.omega[0], stages.alpha[0], stages.opening[0],
                       stages.r[0], stages.V[0], stages.A[0])  # fmt: skip


class Equations:
    """Residual and tangent of a scene's equilibrium."""

    def __init__(self, scene: Scene) -> None:
        N, length = scene.numerics.intervals, float(scene.rod.length)
        self.s, self.t_end = np.linspace(0.0, length, N + 1), scene.t_end
        self.applied = loads_on_segments(scene, self.s, times=1)
        self.loads = self.applied.records
        self.chain = chain_of(scene.rod, self.applied.entrained, self.s)
        state, self.offset = lay_out(scene, self.chain, self.s)
        self.start = Point(state.quaternion.copy(), state.base[0].copy(), np.zeros((N + 1, 3)), 0.0)
        self.stages, self.tangents, self._stored = Stages.empty(N), Tangents.empty(N), Tangents.empty(N)
        self._driven, self._residuals = Driven.empty(N), Residuals.empty(N)
        self._moments = np.zeros((2, 3))
        """On the ends, material, of the point that was looked at last."""
        _lay_down(self.chain, state.quaternion, self.start.base, self.start.F, self.stages)
        R = self.stages.R[0]
        self.ends = (StaticEnd(scene.start, R[0]), StaticEnd(scene.end, R[-1]))
        self.compliance, self._stretches = 0.5 * axial_compliance(scene), can_stretch(scene.rod)
        self.contact = StaticContact(scene, self.s, self.nodes())
        self.contact.prepare(self.bending(), self.nodes(), np.zeros((N + 1, 3)))
        self._home = (state.quaternion[[0, -1]].copy(), np.stack([self.start.base, self.tip()]))
        self.stiffness = mean_bending(self.chain.elastic)
        self._moment, self._force = self.stiffness / length, self.stiffness / length**2
        self.units = np.repeat([1.0, length, self._force], 3)
        self._rows = 1.0 / np.repeat([self._moment, self._force, length], 3)
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

    def let_go(self) -> None:
        """Nothing holds the initial shape any more; q is now the schedules' time."""
        self.letting_go = False

    def time(self, q: float) -> float:
        """The schedules' time (s) at the parameter q."""
        return 0.0 if self.letting_go else q * self.t_end

    def loading(self) -> float:
        """The scale on which a stiffness or a force counts as none: the largest force in the rod in EJ/L^2, of the
        point evaluated last, between 1 and MOST_LOADED."""
        return float(np.clip(np.abs(self.stages.F[0]).max() / self._force, 1.0, MOST_LOADED))

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
            _lay_down(self.chain, guess.quaternion, guess.base, guess.F, self.stages)
            there = self.nodes()
            _lay_down(self.chain, point.quaternion, point.base, point.F, self.stages)
            self.contact.prepare(self.bending(), self.nodes(), there - self.nodes())

    def keeps_apart(self, z: Array) -> bool:
        """Whether a displacement of the point evaluated last leaves strands that press on each other apart."""
        return not self.contact.pressing or self.contact.allowed(self.moved_nodes(z)) >= 1.0

    def keep(self) -> None:
        """Enter that a step was taken to the point evaluated last."""
        if self.contact.present:
            self.contact.keep(self.nodes())

    def refusal(self) -> str:
        """Why contact does not let the point evaluated last be trusted, after a step, or nothing."""
        return self.contact.refusal(self.bending(), self.nodes()) if self.contact.present else ""

    def residual(self, point: Point) -> Array:
        """What is left of the equations at a point (N + 2, 9), dimensionless."""
        _lay_down(self.chain, point.quaternion, point.base, point.F, self.stages)
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
        for side in (0, 1):
            self._balance_end(side, t, point, left)
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

    def slope(self, point: Point, ahead: float, step: float = 1e-6) -> Array:
        """How the residual changes with q beside the point evaluated last, at q + `ahead` (N + 2, 9)."""
        if self.letting_go:
            return self._what_holds()
        sides = [Point(point.quaternion, point.base, point.F, point.q + ahead + x) for x in (step, -step)]
        up, down = (self._left(side) for side in sides)
        return (up - down) / (2.0 * step)

    def _balance_end(self, side: int, t: float, point: Point, left: Array) -> None:
        """Write the rows of an end: what is not balanced, or by how much it is away from where it is held."""
        end, frame, sign = self.ends[side], -side, 2.0 * side - 1.0
        R, values, s = self.stages.R[0, frame], end.values(t), float(self.s[-1]) * side
        dead, follower = self.applied.at_end(t, s, "lab"), self.applied.at_end(t, s, "material")
        self._driven.dead[0, side] = dead
        inner = self.stages.left[0, 0] if side == 0 else self.stages.right[0, -1]
        loaded = np.where(end.held, 0.0, values)
        self._moments[side] = loaded[3:] + follower[3:]
        self._follower(side)[:] = follower[:3] + (loaded[:3] if end.follows else 0.0)
        force = dead[:3] + R @ self._follower(side) + (0.0 if end.follows else loaded[:3])
        across = end.axes.T @ (sign * (point.F[frame] - force)) / self._force
        place = point.base if side == 0 else self.tip()
        if self.compliance > 0.0:
            place = place + self._give(side, R) @ point.F[frame]
        away = (end.axes.T @ (place - self._home[1][side]) - values[:3]) / self.units[3]
        moment = sign * (inner - R.T @ dead[3:] - follower[3:] - loaded[3:]) / self._moment
        turned = self._turned(side, values[3:], point.quaternion[frame])
        left[frame, PSI] = np.where(end.held[3:], turned, moment) * self._moment
        left[frame, X] = np.where(end.held[:3], away, across) * self._force

    def _give(self, side: int, R: Array) -> Array:
        """What takes the force at an end to how far what holds it is from the rod's end (3, 3): see `physics.axial`."""
        return np.asarray((2.0 * side - 1.0) * self.compliance * np.outer(R[:, 2], R[:, 2]))

    def _give_by_rotation(self, side: int, R: Array, F: Array) -> Array:
        """How that times the force (3,) changes with a rotation of the end's frame (3, 3): the tangent turns."""
        turned = np.column_stack([-R[:, 1], R[:, 0], np.zeros(3)])
        changed = turned * (R[:, 2] @ F) + np.outer(R[:, 2], F @ turned)
        return np.asarray((2.0 * side - 1.0) * self.compliance * changed)

    def strain(self) -> float:
        """The largest strain; or how far the ends are stretched, in rod lengths; of the point evaluated last."""
        if self._stretches:
            return float((np.abs(self.stages.opening[0, 0]) / self.chain.span).max())
        forces, tangents = self.stages.F[0, [0, -1]], self.stages.R[0, [0, -1], :, 2]
        return float(self.compliance * np.abs(np.sum(forces * tangents, axis=1)).sum() / self.s[-1])

    def loads_turn(self) -> bool:
        """Whether loads have no potential, of the point that was looked at last: what turns with the rod, as a moment
        on an end that is free about more than one axis, or depends on the place in a way that no energy does."""
        K = self.tangents.K
        skew = np.abs(K - np.swapaxes(K, 1, 2)).max() > SKEW * np.abs(K).max()
        moments = [self._moments[side].any() and end.held[3:].sum() < 2 for side, end in enumerate(self.ends)]
        return bool(skew or self.tangents.E.any() or self._driven.values[0, :, :3].any() or any(moments))

    def _follower(self, side: int) -> Array:
        """Forces (3,) that follow an end's frame."""
        return self._driven.values[0, side, :3]

    def _turned(self, side: int, values: Array, quaternion: Array) -> Array:
        """By how much an end's frame is turned away from where it is held (3,), by the rotations in `values` (3,)."""
        end, there, away = self.ends[side], np.empty(4), np.empty(3)
        if not end.held[3:].any():
            return np.zeros(3)
        turn(self._home[0][side], np.where(end.held[3:], values, 0.0), there)
        if end.held[3:].all():
            relative_rotation(there, quaternion, away)
            return away
        free = np.eye(3)[int(np.argmin(end.held[3:]))]
        return np.cross(rotation_of(quaternion).T @ rotation_of(there) @ free, free)

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
            return left, CoupledSolver(self.blocks(), self._contact_tangent(), self.units)
        return left, Solver(*self.blocks(), self.units)

    def moved_nodes(self, z: Array) -> Array:
        """How far a displacement z (N + 2, 9) moves the nodes (N + 1, 3), of the point evaluated last."""
        moves, z = self._opened(self._moves()), z / self.units
        return np.asarray((moves[:, 0] @ z[:-1, :, None] + moves[:, 1] @ z[1:, :, None])[:, :, 0])

    def _moves(self) -> Array:
        """What takes the dimensionless displacements of the orientations before and behind each node to its own, m
        (N + 1, 2, 3, 9): to that of either segment beside it, as these bear the forces there."""
        lever = levers(self.stages.R[0], self.chain.h).transpose(0, 2, 1)
        moves = np.zeros((len(self.s), 2, 3, BLOCK))
        for side, tip, sign in ((0, slice(1, None), -1.0), (1, slice(-1), 1.0)):
            moves[tip, side, :, X] = self.units[X] * np.eye(3)
            moves[tip, side, :, PSI] = sign * lever[1:-1]
        moves[1:-1] *= 0.5
        return moves

    def _opened(self, moves: Array) -> Array:
        """The same of the rod's nodes: at its ends the joints open between the orientations beside them."""
        if self._stretches:
            opens = self.tangents.opens[[0, -1]] * np.array([-1.0, 1.0])[:, None, None, None]
            moves[[0, -1], :, :, PSI] += opens[:, :2]
            moves[[0, -1], 1, :, FORCE] += opens[:, 2] * self.units[6]
        return moves

    def _contact_tangent(self) -> csr_array:
        """What contact adds to the tangent (9 (N + 2), 9 (N + 2)), dimensionless."""
        (S, coupled), moves, n = self.contact.stiffness(), self._moves(), len(self.s)
        one, other = np.nonzero(coupled)
        blocks = S[one, :, other] * self._rows[PSI.start], other, np.searchsorted(one, np.arange(n + 1))
        pushed = bsr_array(blocks, shape=(3 * n, 3 * n)) @ _by_blocks(self._opened(moves.copy()))
        return csr_array(_by_blocks(moves).T @ pushed)

    def blocks(self) -> tuple[Array, Array, Array]:
        """Diagonal (N + 2, 9, 9) of the tangent, and the blocks before and behind it, dimensionless."""
        T, R, n = self.tangents, self.stages.R[0], len(self.start.quaternion)
        D, lower, upper = (np.zeros((n, BLOCK, BLOCK)) for _ in range(3))
        lever, one = levers(R, self.chain.h), np.eye(3)
        D[:, PSI, PSI], lower[:, PSI, PSI], upper[:, PSI, PSI] = T.stiff, T.before, T.behind
        D[:, PSI, PSI] += SOFTEST * self.stiffness * self.chain.h / self.s[-1] ** 2 * one
        D[1:, PSI, FORCE], upper[:-1, PSI, FORCE] = lever[1:], lever[:-1]
        D[1:-1, X, PSI], D[1:-1, X, X] = -T.E, T.K + SOFTEST_PLACE * np.abs(T.K).max() * one
        if self.letting_go and self._turning:
            D[1:-1, X, PSI] += self._held * self._force * R[1:-1] @ _cross(self.holding[1:-1, X])
        D[1:, X, FORCE], upper[:-1, X, FORCE] = one, -one
        D[1:, FORCE, PSI], lower[1:, FORCE, PSI] = lever[1:].transpose(0, 2, 1), lever[:-1].transpose(0, 2, 1)
        D[1:, FORCE, X], lower[1:, FORCE, X] = one, -one
        D[0, FORCE, FORCE] = one * self.units[3] / self.units[6]
        if self._stretches:
            before, behind, by_force = T.opens[:, 0], T.opens[:, 1], T.opens[:, 2]
            D[1:, FORCE, FORCE] -= by_force
            D[1:, FORCE, PSI] -= behind
            D[1:, PSI, FORCE] -= behind.transpose(0, 2, 1)
            lower[1:, FORCE, PSI] -= before
            upper[:-1, PSI, FORCE] -= before.transpose(0, 2, 1)
        for side, end in enumerate(self.ends):
            a, sign = -side, 2.0 * side - 1.0
            if self._follower(side).any():
                D[a, X, PSI] = sign * R[a] @ _cross(self._follower(side))
            for block in (D[a], lower[a], upper[a]):
                block[X] = end.axes.T @ block[X]
                block[PSI][end.held[3:]] = 0.0
                block[X][end.held[:3]] = 0.0
            D[a, PSI, PSI][end.held[3:]] = one[end.held[3:]] * self._moment
            D[a, X, X][end.held[:3]] = end.axes.T[end.held[:3]] * self._force / self.units[3]
            if self.compliance == 0.0:
                continue
            force = upper[0] if side == 0 else D[-1]
            rows = end.axes.T[end.held[:3]] * self._force / self.units[3]
            force[X, FORCE][end.held[:3]] = rows @ self._give(side, R[a])
            D[a, X, PSI][end.held[:3]] = rows @ self._give_by_rotation(side, R[a], self.stages.F[0, a])
        scale = self._rows[:, None] * self.units
        return D * scale, lower * scale, upper * scale


def levers(R: Array, h: float) -> Array:
    """(h/2) a3 x R^t (n, 3, 3): the moment of a unit force at a segment's node; none for the ends' frames."""
    lever = np.zeros((len(R), 3, 3))
    lever[1:-1, 0], lever[1:-1, 1] = 0.5 * h * R[1:-1, :, 1], -0.5 * h * R[1:-1, :, 0]
    return lever


def _by_blocks(moves: Array) -> bsr_array:
    """What takes a displacement of all orientations to those of the nodes, of what does for each node."""
    n = len(moves)
    columns = (np.arange(n)[:, None] + np.arange(2)).ravel()
    blocks = moves.reshape(2 * n, 3, BLOCK), columns, 2 * np.arange(n + 1)
    return bsr_array(blocks, shape=(3 * n, BLOCK * (n + 1)))


def _turned_by(R: Array, forces: Array) -> Array:
    """Those on segments (N, 3) by the rotations of all orientations (N + 2, 3, 3)."""
    return np.asarray((R[1:-1] @ forces[:, :, None])[:, :, 0])


def _cross(x: Array) -> Array:
    """The matrices [x] (..., 3, 3) of vectors (..., 3)."""
    matrices = np.zeros((*x.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        matrices[..., k, j], matrices[..., j, k] = x[..., i], -x[..., i]
    return matrices


@cache
def _places(n: int) -> tuple[tuple[NDArray[np.bool_], tuple[NDArray[np.int64], NDArray[np.int64]]], ...]:
    """Where the entries of the diagonal, lower and upper blocks lie in LAPACK's band storage."""
    a, p, q = np.meshgrid(np.arange(n), np.arange(BLOCK), np.arange(BLOCK), indexing="ij")
    places = []
    for shift in (0, -1, 1):
        row, column = BLOCK * a + p, BLOCK * (a + shift) + q
        keep = (np.abs(row - column) <= BAND) & (column >= 0) & (column < BLOCK * n)
        places.append((keep, (2 * BAND + (row - column)[keep], column[keep])))
    return tuple(places)


class Solver:
    """The factored tangent of one point."""

    def __init__(self, D: Array, lower: Array, upper: Array, units: Array) -> None:
        self._units, self._shape = units, (len(D), BLOCK)
        bands = np.zeros((3 * BAND + 1, BLOCK * len(D)), order="F")
        for block, (keep, place) in zip((D, lower, upper), _places(len(D)), strict=True):
            bands[place] = block[keep]
        self._factors, self._pivots, info = dgbtrf(bands, BAND, BAND, overwrite_ab=True)
        pivots = np.abs(self._factors[2 * BAND])
        self.singular = bool(info > 0) or not np.isfinite(pivots).all()

    def solve(self, right: Array) -> Array:
        """The displacement (N + 2, 9) that the tangent takes to `right` (N + 2, 9)."""
        x, _ = dgbtrs(self._factors, BAND, BAND, right.ravel(), self._pivots)
        return np.asarray(x.reshape(self._shape) * self._units)


class CoupledSolver:
    """The same where strands press on each other, whose nodes may be far apart along s."""

    def __init__(self, blocks: tuple[Array, Array, Array], contact: csr_array, units: Array) -> None:
        D, lower, upper = blocks
        n = len(D)
        self._units, self._shape = units, (n, BLOCK)
        data = np.stack([lower, D, upper], axis=1).reshape(-1, BLOCK, BLOCK)[1:-1]
        columns = (np.arange(n)[:, None] + np.arange(-1, 2)).ravel()[1:-1]
        starts = np.clip(3 * np.arange(n + 1) - 1, 0, 3 * n - 2)
        chain = bsr_array((data, columns, starts), shape=(BLOCK * n, BLOCK * n))
        self.singular = False
        try:
            self._factors: SuperLU = splu((chain.tocsr() + contact).tocsc(), relax=1, panel_size=1)  # it is narrow
        except RuntimeError:  # as it says that a pivot vanished
            self.singular = True

    def solve(self, right: Array) -> Array:
        """The displacement (N + 2, 9) that the tangent takes to `right` (N + 2, 9)."""
        return np.asarray(self._factors.solve(right.ravel()).reshape(self._shape) * self._units)
