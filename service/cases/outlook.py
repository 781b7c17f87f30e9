"""How long a run to a tolerance is likely to take: what sets the rod moving says more of it than its size.

A run whose motion the frames follow needs a few coarse meshes. One that is let go, loaded at once or thrown has waves
that only short steps follow, and one that is wound up buckles and winds on: there the work grows until what may be
spent is spent. The seconds of CPU time are about the medians of such scenes in `stress/plausible/bank.py`, of 40 to 60
frames each, at a tolerance of 1e-3. How many scenes of that bank they are right for to a factor of 3 stands in
`stress/results/plausible.md`; of its kinds no number that is the same for all scenes of a kind is right for more than
nine in ten.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from solver import Scene
from solver.arrays import Array
from solver.kernels.rotation import rotate
from solver.methods.space.one_axis.axis import axis_of
from solver.physics.axial import axial_compliance
from solver.physics.elasticity import elasticity_of, moments, principal
from solver.physics.loads import solids
from solver.physics.section import sample
from solver.run.first_mesh import twisted
from solver.scene.ends import End
from solver.scene.layout import nodes_at_rest

WOUND, HELD, ON_FLOOR, IN_SPACE, DEEP, IN_WATER, LET_GO, FOLLOWED = 8.0, 2.5, 7.0, 1.8, 2.0, 0.45, 2.0, 0.25
TURN = 15.0
"""Rotation (rad) of the ends relative to each other from which on a rod is taken to buckle and wind itself up."""
INTERVALS = 16
SMALL = 1e-3
"""Moment, in EJ/L, that sets nothing moving."""
MUCH = 100.0
"""Damping, in the rod's first angular frequency, with which nothing swings."""
LIMP = 1e5
"""Weight, in EJ/L^2, of a rod that bends by its ends in so short a part that the meshes have to be fine."""
FIRST_FREQUENCY = 3.516
"""Of a cantilever, in sqrt(EJ / mu) / L^2."""


def likely_seconds(scene: Scene) -> float:
    """CPU seconds at a tolerance of 1e-3, but for what very many frames or nodes cost."""
    overdamped = scene.damping > MUCH * _frequency(scene)
    if twisted(scene) > TURN and not overdamped:
        return WOUND
    if axial_compliance(scene) > 0.0:
        return HELD
    if any(isinstance(load, solids.Given) for load in scene.loads):
        return ON_FLOOR
    if overdamped:
        return FOLLOWED
    if axis_of(replace(scene, numerics=replace(scene.numerics, intervals=INTERVALS))) is None:
        return IN_SPACE
    if scene.fluid is not None:
        stiffness, mass = _mean(scene)
        weight = float(np.linalg.norm(scene.gravity)) * mass * scene.rod.length**3
        return DEEP if weight > LIMP * stiffness else IN_WATER
    swings = scene.damping < 2.0 * _frequency(scene)
    return LET_GO if swings and _is_let_go(scene) else FOLLOWED


def _frequency(scene: Scene) -> float:
    """The first angular frequency (rad/s) of the rod as a cantilever."""
    stiffness, mass = _mean(scene)
    return float(FIRST_FREQUENCY * np.sqrt(stiffness / mass) / scene.rod.length**2)


def _mean(scene: Scene) -> tuple[float, float]:
    """EJ (N m^2) of the softer axis and mass per length (kg/m)."""
    s = np.linspace(0.0, scene.rod.length, INTERVALS + 1)
    softer = principal(elasticity_of(scene.rod, s))[:, :2].min(axis=1)
    return float(softer.mean()), float(sample(scene.rod, s).mass.mean())


def _is_let_go(scene: Scene) -> bool:
    """Whether the rod is not at rest where it begins: by its stress, its weight, a load that is there at once, or its
    motion."""
    length, (stiffness, mass) = float(scene.rod.length), _mean(scene)
    s = np.linspace(0.0, length, INTERVALS + 1)
    _, quaternion, kappa = nodes_at_rest(scene.initial, s)
    tangent = rotate(quaternion, np.tile([0.0, 0.0, 1.0], (len(quaternion), 1)))
    weight = float(np.linalg.norm(np.cross(tangent, scene.gravity), axis=1).mean()) * mass * length**3
    stress = float(np.abs(moments(elasticity_of(scene.rod, s), kappa)).max()) * length
    crossed = [np.cross(tangent[0], [c.value(0.0) for c in load.force]) for load in scene.points]
    across = [float(np.linalg.norm(force)) for force in crossed]
    across += [_across(scene.start, tangent[0]), _across(scene.end, tangent[-1])]
    thrown = any((*scene.initial.velocity, *scene.initial.angular_velocity))
    return thrown or max(weight, stress, max(across) * length**2) > SMALL * stiffness


def _across(end: End, tangent: Array) -> float:
    """The force (N) across the rod that is there at once at a free end."""
    loads = [c[0].curve.value(0.0) if c[0].kind == "load" else 0.0 for c in end.translation]
    return float(np.linalg.norm(np.cross(tangent, loads) if end.frame == "lab" else loads[:2]))
