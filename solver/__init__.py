"""The rod solver: numbers only. `for frame in simulate(scene): ...`."""

from solver.curve import Curve, Vector, constant_vector
from solver.frame import Frame, Statistics
from solver.kernel import code_digest
from solver.methods.statics.ends import check_end
from solver.outcome import REMEDY, Outcome, RunFailed
from solver.rod import Rod
from solver.run import Run
from solver.scene import (
    FIXED,
    FREE,
    Condition,
    Contact,
    DistributedLoad,
    End,
    Fluid,
    Initial,
    Numerics,
    PointLoad,
    Scene,
)
from solver.simulate import simulate
from solver.simulation import Simulation, warm
from solver.verify import Verified, VerifiedFrame

__all__ = [
    "FIXED", "FREE", "REMEDY", "Condition", "Contact", "Curve", "DistributedLoad", "End", "Fluid", "Frame",
    "Initial", "Numerics", "Outcome", "PointLoad", "Rod", "Run", "RunFailed", "Scene", "Simulation", "Statistics",
    "Vector", "Verified", "VerifiedFrame", "check_end", "code_digest", "constant_vector", "simulate", "warm",
]
