"""Which run a scene asks for."""

from __future__ import annotations

from solver.physics.seed import seeded
from solver.run.equilibria import Equilibria
from solver.run.refined import Refined
from solver.run.run import Run
from solver.run.simulation import Simulation
from solver.run.verify import Verified
from solver.scene.scene import Scene


def simulate(scene: Scene) -> Run:
    """The run of a scene: iterate over it for its frames, from t = 0 to t_end."""
    scene = seeded(scene)
    if scene.numerics.tolerance is not None:
        return Refined(scene)
    kind = Equilibria if scene.at_rest else Simulation
    return Verified(scene, kind) if scene.numerics.verify else kind(scene)
