"""The tangents of the staggered method are the derivatives of its residuals, for every term and kind of end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from solver import End, Fluid, Initial, Numerics, Scene
from solver.arrays import Array
from solver.kernels.rotation import matrix_of, turn
from solver.methods.space.segments.balances import balance_segments, condition_ends, segment_tangents
from solver.methods.space.segments.joints import bend_joints
from solver.methods.staggered import StaggeredMethod
from solver.physics.loads.registry import Loads
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


@dataclass
class Problem:
    """One stage of a chain in an arbitrary state."""

    method: StaggeredMethod
    loads: Loads

    def residuals(self) -> tuple[Array, Array, Array]:
        """Of rotation, with the sign of the system's rows, of translation, and of the ends."""
        method, stages, residuals = self.method, self.method.stages, self.method.work.residuals
        call(bend_joints, method.chain, *(a[STAGE] for a in (stages.quaternion, stages.bend, stages.moment, stages.left,
                                                             stages.right)))  # fmt: skip
        call(balance_segments, method.chain, self.loads, method.driven, stages, residuals, STAGE)
        call(condition_ends, method.chain, method.driven, stages, residuals, STAGE)
        rotation = residuals.rotation[STAGE].copy()
        rotation[0] *= -1.0
        return rotation, residuals.translation[STAGE].copy(), residuals.ends[STAGE].copy()

    def turned(self, a: int, axis: int) -> tuple[Array, Array, Array]:
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
        one, two, three = ((up - down) / (2.0 * STEP) for up, down in zip(*sides, strict=True))
        return one, two, three

    def changed(self, part: int, *changes: tuple[Array, Array]) -> Array:
        """Derivative of one part of the residuals along `changes` (array, direction)."""
        sides = []
        for sign in (1.0, -2.0):
            for array, direction in changes:
                array += sign * STEP * direction
            sides.append(self.residuals()[part])
        for array, direction in changes:
            array += STEP * direction
        return np.asarray((sides[0] - sides[1]) / (2.0 * STEP))


def problem(term: str, kinds: str, fluid: Fluid | None = None) -> Problem:
    random = np.random.default_rng(7)
    scene = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0, fluid=fluid,
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


CASES = [(term, "mixed", None) for term in TERMS] + [("nothing else", kinds, None) for kinds in KINDS]
CASES += [("all of them", "mixed", Fluid(1000.0, 1.0, 1.2, 0.3, (0.4, -0.2, 0.1)))]  # type: ignore[list-item]


@pytest.mark.parametrize(("term", "kinds", "fluid"), CASES)
def test_the_tangents_by_rotation_are_derivatives(term: str, kinds: str, fluid: Fluid | None) -> None:
    case = problem(term, kinds, fluid)
    tangents = case.method.work.tangents
    largest = np.abs(tangents.stiff).max()
    for a in range(N + 2):
        for axis in range(3):
            rotation, translation, ends = case.turned(a, axis)
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
            found = case.changed(1, (array[STAGE], direction))
            assert np.abs(found - blocks[:, :, axis]).max() <= LARGEST_ERROR * np.abs(blocks).max()
        # a rotation at a rate phi_t, in a frame that does not turn
        phi_t = np.zeros((N + 2, 3))
        phi_t[:, axis] = 1.0
        turning = -np.cross(stages.omega[STAGE], phi_t)
        found = case.changed(0, (stages.omega[STAGE], phi_t), (stages.alpha[STAGE], turning))
        assert np.abs(found[1:-1] - tangents.spin[:, :, axis]).max() <= LARGEST_ERROR * np.abs(tangents.spin).max()
