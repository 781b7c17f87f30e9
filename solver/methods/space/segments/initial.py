"""The chain of a rod, and how it lies at t = 0."""

from __future__ import annotations

from typing import Any

import numpy as np

from solver.arrays import Array
from solver.kernels.rotation import rotate_back
from solver.methods.space.segments.chain import Chain, State
from solver.methods.space.segments.joints import bend_joints
from solver.physics.cells import around_nodes, between_nodes
from solver.physics.elasticity import elasticity_of, elasticity_over
from solver.physics.loads.applied import AppliedLoads
from solver.physics.section import Section, sample_over
from solver.scene.curve import corners_of
from solver.scene.layout import curvature_of, nodes_at_rest
from solver.scene.rod import Profiles, Rod
from solver.scene.scene import Scene

LITTLE, SMALLEST = 0.01, 1e-300
"""Of the mean square of kappa0: the square of a curvature that counts as next to none."""


def segments_of(rod: Rod, s: Array) -> Section:
    """The section of the segments between nodes `s` (N + 1,), with the inertia of whole segments."""
    section = sample_over(rod, between_nodes(s, rod.corners))
    return section._replace(inertia=section.inertia + np.outer(section.mass, _across(s)))


def _across(s: Array) -> Array:
    """h^2 / 12 about the axes across a segment: of its inertia per mass."""
    h = float(s[1] - s[0])
    return np.array([1.0, 1.0, 0.0]) * h * h / 12.0


def loads_on_segments(scene: Scene, section: Section, s: Array, times: int, axis: Any = None) -> AppliedLoads:
    """The loads of a scene on the segments between nodes `s` (N + 1,), of which `section` is that of `segments_of`, at
    so many times within a step."""
    middles = 0.5 * (s[1:] + s[:-1])
    return AppliedLoads(scene, section, middles, np.diff(s), times, axis)


def chain_of(rod: Rod, section: Section, entrained: Array, s: Array) -> Chain:
    """The chain of a rod with nodes `s` (N + 1,), whose segments have that `section` and take the mass `entrained` (N,)
    along by loads."""
    h = float(s[1] - s[0])
    wet = section.inertia + np.outer(entrained, _across(s))
    joints = around_nodes(s, rod.corners)
    elastic = elasticity_over(elasticity_of(rod, joints.points), joints)
    if corners_of(*rod.kappa0):
        elastic = elastic._replace(kappa0=_in_joints(rod.kappa0, rod, s))
    return Chain(h, section.mass, wet, section.inertia, _span(s), elastic)


def _in_joints(curvature: Profiles, rod: Rod, s: Array) -> Array:
    """What a curvature along the rod counts for in the joints at `s` (n,), where the natural one has corners."""
    joints, h, span = around_nodes(s, corners_of(*rod.kappa0)), float(s[1] - s[0]), _span(s)
    return np.stack([joints.placed_mean_of(component, span, h) for component in curvature], axis=1)


def _span(s: Array) -> Array:
    """The lengths (n,) that joints at `s` (n,) stand for."""
    span = np.full(len(s), float(s[1] - s[0]))
    span[0] = span[-1] = 0.5 * span[0]
    return span


def _has_steps(rod: Rod, chain: Chain, s: Array) -> bool:
    """Whether the natural curvature of some joint at `s` (n,) is not that of its node."""
    if not corners_of(*rod.kappa0):
        return False
    return bool((chain.elastic.kappa0 != np.stack([profile(s) for profile in rod.kappa0], axis=1)).any())


def lay_out(scene: Scene, chain: Chain, s: Array) -> tuple[State, Array]:
    """The state at t = 0, and by how much the joints' curvature (N + 1, 3) differs from the centreline's own, as far as
    that is the natural one.

    kappa0 is shifted by as much, so that a rod whose natural shape is its initial one starts without stress. That of a
    straight one is not: a curvature of its own, however small, turns a rod that nothing else keeps from spinning.
    """
    state, initial = State.empty(len(s) - 1), scene.initial
    r, quaternion, kappa = nodes_at_rest(initial, np.linspace(0.0, s[-1], 2 * len(s) - 1))
    state.quaternion[0], state.quaternion[1:-1], state.quaternion[-1] = quaternion[0], quaternion[1::2], quaternion[-1]
    spin = np.array(initial.angular_velocity, dtype=float)
    state.omega[:] = rotate_back(state.quaternion, np.tile(spin, (len(state.omega), 1)))
    arm = r[0] - np.average(r[1::2], axis=0, weights=chain.mass)
    state.base[0] = r[0]
    state.base[1] = np.array(initial.velocity, dtype=float) + np.cross(spin, arm)
    state.base[2] = np.cross(spin, np.cross(spin, arm))
    bend, moment, left, right = (np.zeros((len(s), 3)) for _ in range(4))
    bend_joints(chain, state.quaternion, bend, moment, left, right)
    own = kappa[::2]
    if own.any() and _has_steps(scene.rod, chain, s):
        own = _in_joints(curvature_of(initial, float(s[-1]), len(s) - 1), scene.rod, s)
    offset = natural_part(chain.elastic.kappa0, own) * (bend / chain.span[:, None] - own)
    chain.elastic.kappa0[:] += offset
    return state, offset


def natural_part(kappa0: Array, kappa: Array) -> Array:
    """Which part (n, 1), from 0 to 1, of curvatures kappa (n, 3) is natural: all where they are kappa0, and where they
    are next to none beside kappa0; nothing of a rod that is straight by nature."""
    little = LITTLE * np.mean(np.sum(kappa0**2, axis=1))
    along, square = np.sum(kappa0 * kappa, axis=1), np.sum(kappa**2, axis=1)
    return np.asarray(np.clip((along + little) / (square + little + SMALLEST), 0.0, 1.0)[:, None])
