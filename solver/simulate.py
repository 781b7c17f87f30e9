"""Which run a scene asks for."""

from __future__ import annotations

from solver.frame import Statistics
from solver.methods.statics.run import Equilibria
from solver.pilot import Piloted
from solver.run import Run
from solver.scene import Scene
from solver.simulation import Simulation
from solver.verify import Verified


def simulate(scene: Scene) -> Run:
    """The run of a scene: iterate over it for its frames, from t = 0 to t_end."""
    return resolved(scene) if scene.numerics.tolerance is None else Piloted(scene, resolved)


def resolved(scene: Scene, statistics: Statistics | None = None) -> Run:
    """The run of a scene with the intervals and steps that it gives."""
    kind = Equilibria if scene.analysis == "static" else Simulation
    return Verified(scene, kind, statistics) if scene.numerics.verify else kind(scene, statistics)
