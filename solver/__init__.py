"""The rod solver: numbers only. `for frame in simulate(scene): ...`."""

from solver.measures.frame import Frame, Statistics
from solver.outcome import Outcome, RunFailed
from solver.run.checkpoint import code_digest
from solver.run.refined import Refined
from solver.run.run import Run
from solver.run.simulate import simulate
from solver.run.simulation import Simulation
from solver.run.trial import Trial, strides_of
from solver.run.under_way import UnderWay
from solver.run.verify import Verified, VerifiedFrame
from solver.run.warming import warm
from solver.scene.contact import Contact
from solver.scene.curve import Curve, Vector, constant_vector
from solver.scene.ends import FIXED, FREE, Condition, End
from solver.scene.fluid import Fluid, Shear
from solver.scene.initial import Initial
from solver.scene.loads import DistributedLoad, PointLoad
from solver.scene.numerics import Numerics
from solver.scene.rod import Rod
from solver.scene.scene import Scene
from solver.scene.user import UserLoad
from solver.statics.ends import check_end, check_place

__all__ = [
    "FIXED", "FREE", "Condition", "Contact", "Curve", "DistributedLoad", "End", "Fluid", "Frame", "Initial", "Numerics",
    "Outcome", "PointLoad", "Refined", "Rod", "Run", "RunFailed", "Scene", "Shear", "Simulation", "Statistics", "Trial",
    "UnderWay", "UserLoad", "Vector", "Verified", "VerifiedFrame", "check_end", "check_place", "code_digest",
    "constant_vector", "simulate", "strides_of", "warm",
]
