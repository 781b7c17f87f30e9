"""The kernels of segments that turn about one axis that a step of three stages asks for: see `space.stages`."""

from __future__ import annotations

from solver.arrays import Array
from solver.kernels.kernel import inner, kernel
from solver.methods.space.one_axis.axis import Plane
from solver.methods.space.one_axis.balances import Driven, Tangents, along, balance
from solver.methods.space.one_axis.chain import Chain, Residuals, Stages, State
from solver.methods.space.one_axis.motion import bend_joints
from solver.methods.space.segments.chain import STAGES
from solver.physics.ends import LOAD, RATE
from solver.physics.loads.registry import LoadsAbout


@kernel
def in_contact(touch: None) -> bool:
    """There is none."""
    return False


@inner
def press_stages(chain: Chain, stages: Stages, driven: Driven, touch: None, coupling: None, fresh: bool) -> None:
    """Nothing presses."""


@kernel
def begin_step(state: State, nodes: Array, dt: float, stages: Stages) -> None:
    """Nothing: a steady rotation is no more than a product."""


@inner
def join_stages(chain: Chain, stages: Stages) -> None:
    """Write the moments of the joints at all stages, whose motion is known."""
    for i in range(STAGES):
        bend_joints(chain, stages.phi[i], stages.omega[i], stages.q[i])


@kernel
def evaluate(chain: Chain, loads: LoadsAbout, driven: Driven, stages: Stages, residuals: Residuals) -> None:
    """Write the residuals of all stages, whose motion is known."""
    for i in range(STAGES):
        balance(chain, loads, driven, stages, residuals, i)


@inner
def missed_by_bodies(driven: Driven, stages: Stages, residuals: Residuals, noise: float) -> float:
    """There is none."""
    return 0.0


@inner
def turn_residuals(driven: Driven, stages: Stages, tangents: Tangents, residuals: Residuals) -> None:
    """Turn the rows in material components from the stages' own frames into the tangents', among those of one kind."""
    ends = residuals.ends
    for i in range(STAGES):
        for side in range(2):
            frame = 0 if side == 0 else len(tangents.T) - 1
            turn, kinds, d = stages.T[i, frame] / tangents.T[frame], driven.kinds[side], driven.direction[side]
            one, two = ends[i, side, 0], ends[i, side, 1]
            for k in range(2):
                if kinds[k] in (RATE, LOAD):
                    ends[i, side, k] = 0.0
                    for m, old in ((0, one), (1, two)):
                        if kinds[m] == kinds[k]:
                            ends[i, side, k] += along(d[k], turn * d[m]) * old


@inner
def resist(chain: Chain, driven: Driven, tangents: Tangents, rate: float, velocity: Plane, forces: Array,
           ends: Array) -> None:  # fmt: skip
    """Write the forces (N, 2) of inertia on the segments for accelerations `rate` `velocity` of their centres; there
    are no bodies at the ends."""
    ends[:] = 0.0
    for j in range(len(forces)):
        M, z = tangents.M[j], -rate * velocity[j]
        forces[j, 0], forces[j, 1] = M[0, 0] * z.real + M[0, 1] * z.imag, M[1, 0] * z.real + M[1, 1] * z.imag
