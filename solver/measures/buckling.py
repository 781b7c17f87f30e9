"""Stability of a rod that stays straight, or in its plane: how a small disturbance across it grows.

With small rotations psi of the sections at a state with curvature kappa, moment q and force f, all material, the bend
changes by delta = psi' + kappa x psi, and the Lagrangian's second variation is

    1/2 int delta.(K delta) - q.(psi x delta) + f3 |psi|^2 - psi3 (f.psi) ds.

In a state that turns about its principal axis p alone, a3 where it is straight, kappa and q are along a_p, and psi
across it decouples: of the straight rod it is two bends, of the plane one a bend and a twist. The displacement across
is u' = R (psi x e3), and has the inertia of the rod's mass. Loads are dead loads. So one has Euler's column,
Greenhill's mast and shaft, and Prandtl's beam (Timoshenko & Gere, Theory of Elastic Stability).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.linalg import LinAlgError, cholesky, eigh, matrix_rank, solve, svd

from solver.arrays import Array
from solver.kernels.rotation import rotate, rotation_of
from solver.measures.frame import Fields
from solver.scene.ends import Component
from solver.scene.layout import nodes_at_rest
from solver.scene.loads import have_moments
from solver.scene.scene import Scene
from solver.scene.view import View

INTERVALS = 48
"""Into which the rod is divided."""
MUCH = 20.0
"""Logarithm of the growth, by 5e8, beyond which no rod is straight, or plane, enough to stay so."""
SLOW = 1.5
"""Rate, in sqrt(EJ / m) / L^2, that the error of so few intervals may give to a neutral mode, as where a bow turns
about its pins: what grows more slowly does not count."""
STRAIGHT = 2
"""The axis of a rod that stays so."""


def axis_kept(scene: Scene) -> int | None:
    """The principal axis about which alone the rod ever turns; None if there is none, or if what grows does not follow
    from the second variation: where a load turns with the rod, or something that is not looked at, as a floor, holds
    it."""
    frames = {load.frame for load in scene.points} | {load.frame for load in scene.distributed}
    turning = any(end.frame == "material" and not _held(end.rotation[:2]) and _pushes(end.translation)
                  for end in (scene.start, scene.end))  # fmt: skip
    moments = have_moments(*scene.points, *scene.distributed)  # which have no potential
    if turning or moments or "material" in frames or scene.loads:
        return None
    s = np.linspace(0.0, scene.rod.length, INTERVALS + 1)
    _, quaternion, kappa = nodes_at_rest(scene.initial, s)
    alone, R = _by_itself(scene), rotation_of(quaternion[0])
    return next((p for p in (STRAIGHT, 0, 1) if alone.keeps(View(p, s, quaternion, kappa, R))), None)


def stays_straight(scene: Scene) -> bool:
    """Whether nothing bends a rod that is straight at t = 0."""
    s = np.linspace(0.0, scene.rod.length, INTERVALS + 1)
    _, quaternion, kappa = nodes_at_rest(scene.initial, s)
    return _by_itself(scene).keeps(View(STRAIGHT, s, quaternion, kappa, rotation_of(quaternion[0])))


def _by_itself(scene: Scene) -> Scene:
    """Without bodies, contact and the laws of what is along the rod, which bend nothing."""
    start, end = (replace(end, mass=0.0) for end in (scene.start, scene.end))
    across = tuple(law for law in scene.rod.laws if not getattr(law, "along", False))
    return replace(scene, contact=None, start=start, end=end, rod=replace(scene.rod, laws=across))


@dataclass(frozen=True)
class Transverse:
    """Small motions across the axis `p` that a rod keeps to.

    Their components (m) are psi (n, 2) at the nodes `at` (n,), about the two axes that follow p, those at the start
    where the rod is straight; then the displacements across of the start, in rod lengths. The columns of `basis`
    (m, r) obey the ends and have mass 1. `K` (n - 1, 2): the stiffness about these axes. `slow` (1/s): the rate up to
    which nothing grows, see SLOW.
    """

    p: int
    at: Array
    K: Array
    basis: Array
    slow: float

    @classmethod
    def of(cls, scene: Scene) -> Transverse | None:
        """Of a scene; None where it keeps to no axis, see `axis_kept`."""
        p = axis_kept(scene)
        if p is None:
            return None
        at = np.linspace(0.0, float(scene.rod.length), INTERVALS + 1)
        middles = 0.5 * (at[1:] + at[:-1])
        K = np.stack([scene.rod.stiffness[i](middles) + 0.0 * middles for i in _axes(p)], axis=1)
        M, ends = _mass(scene, p, at), _ends(scene, p, at)
        free = svd(ends)[2][matrix_rank(ends) :].T if len(ends) else np.eye(len(M))
        EJ = min(float(np.min(profile(at))) for profile in scene.rod.stiffness[:2])
        slow = SLOW * np.sqrt(EJ / float(np.mean(scene.rod.mass(at)))) / float(at[-1]) ** 2
        return cls(p, at, K, solve(cholesky(free.T @ M @ free), free.T).T, float(slow))

    def stiffness(self, s: Array, state: Fields) -> Array:
        """(r, r), in 1/s^2, at a state whose nodes are at arclengths `s` (n,)."""
        if self.p == STRAIGHT:
            return self.straight(s, *(rows[:, 2] for rows in (state.kappa, state.q, state.f)))
        axes = _axes(self.p)
        plane = rotation_of(state.orientation[0])[:, axes]
        e3 = np.tile([0.0, 0.0, 1.0], (len(s), 1))
        tangent, force = (rotate(state.orientation, vectors) @ plane for vectors in (e3, state.f))
        angle = np.interp(self.at, s, np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0])))
        chord = np.diff([np.interp(self.at, s, row) for row in (state.r @ plane).T]).T
        middle = np.arctan2(chord[:, 1], chord[:, 0])
        # in the frame of each chord, which has the tangent's place among the axes
        t = np.array([float(axis == 2) for axis in axes])
        upright = _turned(0.5 * np.pi * t[1] - middle)
        f = (upright @ self._means(s, force)[:, :, None])[:, :, 0]
        # where bends are shorter than an interval it is a string
        bears = (f @ t * self.at[1] ** 2 < self.K.min(axis=1)).astype(float)
        f = np.linalg.norm(chord, axis=1)[:, None] * np.where(t > 0.0, f, bears[:, None] * f)
        across = t[:, None] * f[:, None, :]
        pulled = (f @ t)[:, None, None] * np.eye(2) - 0.5 * (across + across.transpose(0, 2, 1))
        moment = bears * self._means(s, state.q[:, [self.p]])[:, 0]
        return self._assembled(angle[:-1] - middle, angle[1:] - middle, moment, pulled)

    def straight(self, s: Array, twist: Array, torque: Array, tension: Array) -> Array:
        """Of a straight rod, likewise, by kappa3, q3 and f3 (n,)."""
        h, (twist, torque, tension) = float(self.at[1]), self._means(s, np.column_stack([twist, torque, tension])).T
        middle = h * (0.5 * twist - np.cumsum(twist))
        return self._assembled(middle, middle, torque, h * tension[:, None, None] * np.eye(2))

    def _means(self, s: Array, values: Array) -> Array:
        """The means over the intervals of `at` of values (n, k) at `s`."""
        steps = 0.5 * np.diff(s)[:, None] * (values[1:] + values[:-1])
        sums = np.vstack([np.zeros(values.shape[1]), np.cumsum(steps, axis=0)])
        return np.asarray(np.diff([np.interp(self.at, s, row) for row in sums.T]).T / self.at[1])

    def _assembled(self, before: Array, after: Array, moment: Array, pulled: Array) -> Array:
        """By the angles (n - 1,) that bring what an interval's nodes have to its own frame, the moment about p in it
        (n - 1,), and what the force does to the mean of both nodes (n - 1, 2, 2)."""
        h, left, right = float(self.at[1]), _turned(before), _turned(after)
        rise, mean = np.concatenate([-left, right], axis=2) / h, 0.5 * np.concatenate([left, right], axis=2)
        blocks = h * rise.transpose(0, 2, 1) @ (self.K[:, :, None] * rise) + mean.transpose(0, 2, 1) @ pulled @ mean
        product = left.transpose(0, 2, 1) @ np.array([[0.0, 1.0], [-1.0, 0.0]]) @ right
        wrung = 0.5 * moment[:, None, None] * product
        blocks[:, :2, 2:] -= wrung
        blocks[:, 2:, :2] -= wrung.transpose(0, 2, 1)
        of_nodes, forces = 2 * len(blocks), np.zeros_like(self.basis)
        beside = blocks @ self.basis[2 * np.arange(len(blocks))[:, None] + np.arange(4)]
        forces[:of_nodes] += beside[:, :2].reshape(of_nodes, -1)
        forces[2 : of_nodes + 2] += beside[:, 2:].reshape(of_nodes, -1)
        return np.asarray(self.basis.T @ forces)


class Disturbance:
    """A small motion across a rod, at random at first. `growth`: the logarithm of the factor by which it has grown.

    It grows between two times at both of which the rod is unstable, and else stays: what is seen once may not last.
    """

    def __init__(self, transverse: Transverse | None, damping: float) -> None:
        """`damping` in 1/s; None: nothing grows."""
        self.growth = 0.0
        self._slow, self._damping = (transverse.slow, damping) if transverse else (0.0, damping)
        self._place = np.random.default_rng(0).standard_normal(transverse.basis.shape[1] if transverse else 0)
        self._speed, self._grew = np.zeros_like(self._place), False

    def go_on(self, dt: float, stiffness: Array) -> None:
        """For a time dt (s) that ends with a `stiffness` (r, r)."""
        grew, self._grew = self._grew, self.grows(stiffness)
        if not self._grew:
            self._speed[:] = 0.0
        if not (grew and self._grew):
            return
        squares, modes = eigh(stiffness)
        c = 0.5 * self._damping
        rate = np.sqrt(c * c - squares.astype(complex))
        rate[rate == 0.0] = self._slow
        fastest = float(rate.real.max())
        rising, falling = np.exp((rate - fastest) * dt), np.exp((-rate - fastest) * dt)
        even, odd = 0.5 * (rising + falling), 0.5 * (rising - falling) / rate
        place, speed = modes.T @ self._place, modes.T @ self._speed
        then = (even * place + odd * (speed + c * place)).real
        moved = (even * speed - odd * (squares * place + c * speed)).real
        size = float(np.linalg.norm(then))
        self.growth += (fastest - c) * dt + float(np.log(size / np.linalg.norm(self._place)))
        self._place[:], self._speed[:] = modes @ then / size, modes @ moved / size

    def grows(self, stiffness: Array) -> bool:
        """Whether any disturbance grows with a `stiffness` (r, r)."""
        try:
            cholesky(stiffness + self._slow**2 * np.eye(len(stiffness)))
        except LinAlgError:
            return True
        return False


def _turned(angles: Array) -> Array:
    """The rotations (n, 2, 2) by angles (n,)."""
    c, s = np.cos(angles), np.sin(angles)
    return np.stack([np.stack([c, -s], axis=1), np.stack([s, c], axis=1)], axis=1)


def _weights(at: Array) -> Array:
    """Of a sum over nodes (n,), m."""
    weights = np.full(len(at), at[1])
    weights[[0, -1]] *= 0.5
    return weights


def _axes(p: int) -> list[int]:
    return [(p + 1) % 3, (p + 2) % 3]


def _moved(p: int, at: Array) -> Array:
    """The displacements across (k, n, m) by the components that `Transverse` describes: u' = R (psi x e3)."""
    n, h = len(at), float(at[1])
    by = {STRAIGHT: [(1, 1.0), (0, -1.0)], 0: [(0, 1.0)], 1: [(1, -1.0)]}[p]
    moved = np.zeros((len(by), n, 2 * n + len(by)))
    for k, (i, sign) in enumerate(by):
        moved[k, 1:, i : 2 * n : 2] = sign * 0.5 * h * np.cumsum(np.eye(n)[1:] + np.eye(n)[:-1], axis=0)
        moved[k, :, 2 * n + k] = float(at[-1])
    return moved


def _mass(scene: Scene, p: int, at: Array) -> Array:
    """(m, m): of the displacements across, and of intervals that turn as sticks, or about themselves."""
    rod, weights = scene.rod, _weights(at)
    borne = rod.mass(at) + 0.0 * at
    if scene.fluid:
        borne = borne + scene.fluid.density * scene.fluid.added_mass * 0.25 * np.pi * rod.diameter(at) ** 2
    moved = _moved(p, at)
    borne = weights * borne
    M = np.asarray(sum(each.T @ (borne[:, None] * each) for each in moved))
    for end, node in ((scene.start, 0), (scene.end, -1)):
        M += end.mass * sum(np.outer(each[node], each[node]) for each in moved)
    for i, axis in enumerate(_axes(p)):
        nodes = 2 * np.arange(len(at)) + i
        M[nodes, nodes] += borne * at[1] ** 2 / 12.0 if axis != 2 else weights * rod.inertia[2](at)
    return M


def _ends(scene: Scene, p: int, at: Array) -> Array:
    """The conditions (k, m) of the ends. One that holds any component of its place is taken to hold it across; one
    that twists a straight rod to hold its tangent, with which the torque would turn."""
    moved, rows = _moved(p, at), []
    for end, node in ((scene.start, 0), (scene.end, len(at) - 1)):
        bends, twist = _held(end.rotation[:2]), _held(end.rotation[2:])
        bends = bends or (p == STRAIGHT and (twist or _pushes(end.rotation[2:])))
        rows += list(moved[:, node]) if _held(end.translation) else []
        for i, axis in enumerate(_axes(p)):
            if twist if axis == 2 else bends:
                rows.append(np.eye(moved.shape[2])[2 * node + i])
    return np.array(rows)


def _held(components: Iterable[Component]) -> bool:
    """Whether any of an end's components is not left to a load, at any time."""
    return any(condition.kind != "load" for component in components for condition in component)


def _pushes(components: Iterable[Component]) -> bool:
    """Whether an end's force is given, and not always zero."""
    return any(c.kind == "load" and not c.curve.is_zero for component in components for c in component)
