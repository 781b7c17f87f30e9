"""Which run a scene asks for."""

from __future__ import annotations

from solver.measures.frame import Statistics
from solver.run.equilibria import Equilibria
from solver.run.refined import Refined
from solver.run.run import Run
from solver.run.simulation import Simulation
from solver.run.verify import Verified
from solver.scene.scene import Scene


def simulate(scene: Scene) -> Run:
    """The run of a scene: iterate over it for its frames, from t = 0 to t_end."""
    return resolved(scene) if scene.numerics.tolerance is None else Refined(scene)


def resolved(scene: Scene, statistics: Statistics | None = None) -> Run:
    """The run of a scene with the intervals and steps that it gives."""
    kind = Equilibria if scene.analysis == "static" else Simulation
    return Verified(scene, kind, statistics) if scene.numerics.verify else kind(scene, statistics)
