"""Which run a scene asks for."""

from __future__ import annotations

from collections.abc import Callable

from solver.physics.seed import seeded
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
    kind: Callable[..., Run] = Simulation
    if scene.at_rest:
        from solver.run.equilibria import Equilibria as kind  # with scipy.linalg, a fifth of a second
    return Verified(scene, kind) if scene.numerics.verify else kind(scene)
