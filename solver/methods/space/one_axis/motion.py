"""The motion of the chain at a stage, from angles to places: `segments.motion` where all turn about one axis.

    phi = phi_n + omega_n tau + theta,   omega = omega_n + theta_t,   alpha = theta_tt,

and the tangent T, with T_t = i omega T where it turns at all, carries each segment on from the one before.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.kernels.copying import copy
from solver.kernels.kernel import inlined, inner, kernel
from solver.methods.space.one_axis.axis import Plane
from solver.methods.space.one_axis.chain import Chain, Stages, State
from solver.methods.space.segments.chain import STAGES, rate_at
from solver.methods.space.segments.motion import differentiate
from solver.physics.elasticity import is_viscous, moment


@kernel
def follow_segments(chain: Chain, T: Plane, omega: Array, alpha: Array, base: Plane,
                    r: Plane, V: Plane, A: Plane) -> None:  # fmt: skip
    """Write position, velocity and acceleration (N,) of the segments' centres, from those of the start, `base`."""
    place, speed, rate = base[0], base[1], base[2]
    for j in range(len(r)):
        arm, w, g = 0.5 * chain.h * T[j + 1], chain.swing * omega[j + 1], chain.swing * alpha[j + 1]
        arm_t, arm_tt = complex(-w * arm.imag, w * arm.real), complex(-g * arm.imag, g * arm.real) - w * w * arm
        r[j], V[j], A[j] = place + arm, speed + arm_t, rate + arm_tt
        place, speed, rate = place + 2.0 * arm, speed + 2.0 * arm_t, rate + 2.0 * arm_tt


@kernel
def move(chain: Chain, state: State, stages: Stages, nodes: Array, inverse: Array, dt: float) -> float:
    """Write all that follows from theta and shift at all stages; return the largest |theta|. `inverse` is A^-1."""
    differentiate(inverse, dt, stages.theta, stages.theta_t)
    differentiate(inverse, dt, stages.theta_t, stages.alpha)
    largest, base, shift = 0.0, stages.base, stages.shift
    for i in range(STAGES):
        base[i, 0] = state.base[0] + shift[i]
        base[i, 1] = rate_at(i, shift, 0.0, inverse, dt)
    for i in range(STAGES):
        base[i, 2] = rate_at(i, base[:, 1], state.base[1], inverse, dt)
        for a in range(len(state.phi)):
            theta = stages.theta[i, a]
            largest = max(largest, abs(theta))
            phi = state.phi[a] + state.omega[a] * nodes[i] * dt + theta
            stages.phi[i, a], stages.omega[i, a] = phi, state.omega[a] + stages.theta_t[i, a]
            angle = chain.swing * phi
            stages.T[i, a] = complex(np.cos(angle), np.sin(angle))
        follow_segments(chain, stages.T[i], stages.omega[i], stages.alpha[i], base[i],
                        stages.r[i], stages.V[i], stages.A[i])  # fmt: skip
    return largest


@kernel
def extrapolate(before: State, theta: Array, dt: float, state: State, nodes: Array, weights: Array, ratio: float,
                ahead: Array) -> None:  # fmt: skip
    """Write theta of a step of ratio dt, if the last step's motion, `theta` from the state `before`, goes on."""
    for i in range(STAGES):
        tau, u, v, w = ratio * dt * nodes[i], weights[i, 0], weights[i, 1], weights[i, 2]
        for a in range(len(state.phi)):
            steady = before.phi[a] - state.phi[a] + (dt + tau) * before.omega[a] - tau * state.omega[a]
            ahead[i, a] = steady + (u * theta[0, a] + v * theta[1, a] + w * theta[2, a])


@inner
def become(state: State, stages: Stages) -> None:
    """Write the state at the last stage."""
    copy(stages.phi[STAGES - 1], state.phi)
    copy(stages.omega[STAGES - 1], state.omega)
    copy(stages.alpha[STAGES - 1], state.alpha)
    copy(stages.base[STAGES - 1], state.base)
    copy(stages.F[STAGES - 1], state.F)


@kernel
def largest_turn(phi: Array) -> float:
    """The largest rotation (rad) within a joint, for angles phi (N + 2,)."""
    largest = 0.0
    for i in range(len(phi) - 1):
        largest = max(largest, abs(phi[i + 1] - phi[i]))
    return largest


@inlined
def joint_moment(chain: Chain, phi: Array, omega: Array, i: int) -> float:
    """The moment of joint i for angles phi (N + 2,) and their rates omega."""
    q = moment(chain.elastic, i, (phi[i + 1] - phi[i]) / chain.span[i])
    if is_viscous(chain.elastic):
        q += chain.elastic.viscosity[i] * (omega[i + 1] - omega[i]) / chain.span[i]
    return float(q)


@kernel
def bend_joints(chain: Chain, phi: Array, omega: Array, q: Array) -> None:
    """Write the moments q of all joints (N + 1,) for angles phi (N + 2,) and their rates omega."""
    for i in range(len(q)):
        q[i] = joint_moment(chain, phi, omega, i)
