"""The tangents of the staggered method are the derivatives of its residuals, for every term and kind of end."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from solver import Curve, End, Fluid, Initial, Numerics, Rod, Scene
from solver.arrays import Array
from solver.kernels.rotation import matrix_of, turn
from solver.methods.space.segments.balances import balance_segments, condition_ends, segment_tangents
from solver.methods.space.segments.joints import bend_joints
from solver.methods.space.segments.opening import add_levers, measure_openings, pull_joints
from solver.methods.staggered import StaggeredMethod
from solver.physics.elasticity import Stretch
from solver.physics.loads.registry import Loads
from solver.statics.tangent import levers
from tests.solver.methods.as_in_runs import call
from tests.solver.scenes import ROD

N, STAGE, STEP = 5, 1, 1e-6
FORCE = 1e-3
LARGEST_ERROR = 1e-7

TERMS = {
    "nothing else": (),
    "damping": ("damping",),
    "following forces and moments": ("following", "dead"),
    "all of them": ("damping", "following", "dead"),
}
KINDS = {
    "held": [[0] * 6, [0] * 6],
    "free": [[1] * 6, [1] * 6],
    "mixed": [[0, 1, 0, 1, 0, 1], [3, 2, 3, 0, 1, 1]],
}


Parts = tuple[Array, Array, Array, Array]


@dataclass
class Problem:
    """One stage of a chain in an arbitrary state."""

    method: StaggeredMethod
    loads: Loads

    def residuals(self) -> Parts:
        """Of rotation, with the sign of the system's rows, of translation, and of the ends; and e t of the joints."""
        method, stages, residuals = self.method, self.method.stages, self.method.work.residuals
        bent = [a[STAGE] for a in (stages.bend, stages.moment, stages.left, stages.right)]
        call(bend_joints, method.chain, stages.quaternion[STAGE], *bent)
        call(pull_joints, method.chain, stages.R[STAGE], stages.F[STAGE], *bent)
        if method.chain.elastic.compliance.size:
            call(measure_openings, method.chain, stages.R[STAGE], stages.F[STAGE], bent[0], stages.opening[STAGE, 0])
        call(balance_segments, method.chain, self.loads, method.driven, stages, residuals, STAGE)
        call(condition_ends, method.chain, method.driven, stages, residuals, STAGE)
        call(add_levers, stages.R[STAGE], stages.F[STAGE], stages.opening[STAGE, 0], residuals.rotation[STAGE])
        rotation = residuals.rotation[STAGE].copy()
        rotation[0] *= -1.0
        T = stages.R[STAGE, 1:-1, :, 2]
        t = 0.5 * (np.vstack([T[:1], T]) + np.vstack([T, T[-1:]]))
        opening = stages.opening[STAGE, 0][:, None] * t
        return rotation, residuals.translation[STAGE].copy(), residuals.ends[STAGE].copy(), opening

    def turned(self, a: int, axis: int) -> Parts:
        """Derivatives of the residuals by a rotation of orientation a about its own axis."""
        stages = self.method.stages
        kept, psi = stages.quaternion[STAGE, a].copy(), np.zeros(3)
        sides = []
        for sign in (1.0, -1.0):
            psi[axis] = sign * STEP
            turn(kept, psi, stages.quaternion[STAGE, a])
            matrix_of(stages.quaternion[STAGE, a], stages.R[STAGE, a])
            sides.append(self.residuals())
        stages.quaternion[STAGE, a] = kept
        matrix_of(kept, stages.R[STAGE, a])
        return derivatives(*sides)

    def changed(self, *changes: tuple[Array, Array]) -> Parts:
        """Derivatives of the residuals along `changes` (array, direction)."""
        sides = []
        for sign in (1.0, -2.0):
            for array, direction in changes:
                array += sign * STEP * direction
            sides.append(self.residuals())
        for array, direction in changes:
            array += STEP * direction
        return derivatives(*sides)


def derivatives(up: Parts, down: Parts) -> Parts:
    one, two, three, four = ((a - b) / (2.0 * STEP) for a, b in zip(up, down, strict=True))
    return one, two, three, four


def problem(term: str, kinds: str, fluid: Fluid | None = None, rod: Rod = ROD) -> Problem:
    random = np.random.default_rng(7)
    scene = Scene(rod, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0, fluid=fluid,
                  damping=0.7 if "damping" in TERMS[term] else 0.0,
                  numerics=Numerics(method="staggered", intervals=N))  # fmt: skip
    method = StaggeredMethod(scene)
    stages, driven = method.stages, method.driven
    for a in range(N + 2):
        turn(method.state.quaternion[a], 0.6 * random.normal(size=3), stages.quaternion[STAGE, a])
        matrix_of(stages.quaternion[STAGE, a], stages.R[STAGE, a])
    for array in (stages.omega, stages.alpha, stages.V, stages.A, stages.base):
        array[STAGE] = random.normal(size=array[STAGE].shape)
    for array in (stages.F, driven.dead, driven.push):
        array[:] = FORCE * random.normal(size=array.shape)
    driven.kinds[:] = KINDS[kinds]
    loads = method.applied.records
    for name in {"following", "dead"}.intersection(TERMS[term]):
        arrays = (FORCE * random.normal(size=array.shape) for array in getattr(loads, name)[1:])
        loads = loads._replace(**{name: type(getattr(loads, name))(True, *arrays)})
    found = Problem(method, loads)
    found.residuals()
    call(segment_tangents, method.chain, found.loads, driven, stages, STAGE, method.work.tangents)
    return found


SOFT = replace(ROD, laws=(Stretch(Curve.table([0.0, 1.0], [2.0 * FORCE, 5.0 * FORCE])),))
"""A rod of which the forces of a problem make another one."""


def test_the_tangents_of_stretch_are_derivatives() -> None:
    check_stretch(SOFT)


def check_stretch(rod: Rod) -> None:
    """Check what a rod's stretch does to the balances, and what they do to it."""
    case = problem("all of them", "free", rod=rod)
    stages, tangents = case.method.stages, case.method.work.tangents
    opens, lever = tangents.opens, levers(stages.R[STAGE], case.method.chain.h)
    assert np.abs(stages.opening[STAGE, 0]).max() > 0.05 / N
    for a in range(N + 2):
        for axis in range(3):
            rotation, _, _, opening = case.turned(a, axis)
            for row in range(max(a - 1, 0), min(a + 2, N + 2)):
                block = (tangents.before, tangents.stiff, tangents.behind)[a - row + 1][row]
                assert np.abs(rotation[row] - block[:, axis]).max() <= LARGEST_ERROR * np.abs(tangents.stiff).max()
            for joint, side in ((a - 1, 1), (a, 0)):
                if 0 <= joint <= N:
                    found = opening[joint] - opens[joint, side, :, axis]
                    assert np.abs(found).max() <= LARGEST_ERROR * np.abs(opens[:, :2]).max()
    for joint in range(N + 1):
        for axis in range(3):
            direction = np.zeros((N + 1, 3))
            direction[joint, axis] = 30.0 * FORCE
            rotation, _, _, opening = (x / (30.0 * FORCE) for x in case.changed((stages.F[STAGE], direction)))
            assert np.abs(opening[joint] - opens[joint, 2, :, axis]).max() <= LARGEST_ERROR * np.abs(opens[:, 2]).max()
            for side in (0, 1):
                found = rotation[joint + side] - lever[joint + side, :, axis] + opens[joint, side, axis]
                assert np.abs(found).max() <= LARGEST_ERROR * np.abs(opens[:, :2]).max()


CASES = [(term, "mixed", None) for term in TERMS] + [("nothing else", kinds, None) for kinds in KINDS]
CASES += [("all of them", "mixed", Fluid(1000.0, 1.0, 1.2, 0.3, (0.4, -0.2, 0.1)))]  # type: ignore[list-item]


@pytest.mark.parametrize(("term", "kinds", "fluid"), CASES)
def test_the_tangents_by_rotation_are_derivatives(term: str, kinds: str, fluid: Fluid | None) -> None:
    check_rotation(problem(term, kinds, fluid))


def check_rotation(case: Problem) -> None:
    """Check what the rotations do to the balances and to the ends' conditions."""
    tangents = case.method.work.tangents
    largest = np.abs(tangents.stiff).max()
    for a in range(N + 2):
        for axis in range(3):
            rotation, translation, ends, _ = case.turned(a, axis)
            rows = [(a, tangents.stiff)] + [(a - 1, tangents.behind)] * (a > 0) + [(a + 1, tangents.before)] * (a <= N)
            for row, blocks in rows:
                frame = None if 0 < row <= N else (0 if row == 0 else 1)
                loaded = [frame is None or case.method.driven.kinds[frame, 3 + k] == 1 for k in range(3)]
                error = np.abs(rotation[row] - blocks[row][:, axis])[loaded]
                assert (error <= LARGEST_ERROR * largest).all()
            if 0 < a <= N:
                scale = np.abs(tangents.E).max() + FORCE
                assert np.abs(translation[a - 1] + tangents.E[a - 1][:, axis]).max() <= LARGEST_ERROR * scale
            else:
                side = 0 if a == 0 else 1
                assert np.abs(ends[side] - tangents.turn[side][:, axis]).max() <= LARGEST_ERROR * 10.0


@pytest.mark.parametrize("fluid", [None, Fluid(1000.0, 1.0, 1.2, 0.3, (0.4, -0.2, 0.1))])
def test_the_tangents_by_rates_are_derivatives(fluid: Fluid | None) -> None:
    case = problem("all of them", "mixed", fluid)
    stages, tangents = case.method.stages, case.method.work.tangents
    for axis in range(3):
        direction = np.zeros((N, 3))
        direction[:, axis] = 1.0
        for array, blocks in ((stages.V, tangents.C), (stages.A, tangents.M)):
            found = case.changed((array[STAGE], direction))[1]
            assert np.abs(found - blocks[:, :, axis]).max() <= LARGEST_ERROR * np.abs(blocks).max()
        # a rotation at a rate phi_t, in a frame that does not turn
        phi_t = np.zeros((N + 2, 3))
        phi_t[:, axis] = 1.0
        turning = -np.cross(stages.omega[STAGE], phi_t)
        found = case.changed((stages.omega[STAGE], phi_t), (stages.alpha[STAGE], turning))[0]
        assert np.abs(found[1:-1] - tangents.spin[:, :, axis]).max() <= LARGEST_ERROR * np.abs(tangents.spin).max()
