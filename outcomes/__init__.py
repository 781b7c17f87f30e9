"""How a run can end: one table of names, meanings and remedies, for solver, worker and service.

It stands below the solver, which gives most of these outcomes, and by itself: the registry of jobs may import it
without the solver, and a better sentence here does not change the solver's sources, by whose digest compiled kernels
and checkpoints are told from those of another version.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Literal, Self

Giver = Literal["solver", "worker", "service"]


class Outcome(StrEnum):
    """Every way in which a run can end, by its name.

    `meaning`: what happened; `remedy`: what the user can do about it, which is also the end of the message; `givers`:
    who ends a run so: the solver, the worker that runs it, or the service, by its reconciler or for the job's owner.
    """

    meaning: str
    remedy: str
    givers: tuple[Giver, ...]

    def __new__(cls, name: str, meaning: str, remedy: str, *givers: Giver) -> Self:
        """One row of the table."""
        outcome = str.__new__(cls, name)
        outcome._value_ = name
        outcome.meaning, outcome.remedy, outcome.givers = meaning, remedy, givers
        return outcome

    COMPLETED = "completed", "the run reached t_end", "", "solver"
    CANCELLED = (
        "cancelled",
        "its owner cancelled it; no dataset is kept",
        "submit the case again to run it to its end",
        "worker", "service",
    )
    NO_CONSISTENT_START = (
        "no_consistent_start",
        "no forces were found with which the rod could start",
        "let loads and ends begin gently; use more intervals, with a tolerance a smaller one; a straight rod that is "
        "held along its axis at both ends needs the method staggered",
        "solver",
    )
    STEP_TOO_SMALL = (
        "step_too_small",
        "even the smallest step, dt_max / 2²², was refused: Newton's iteration stalled, or the motion is faster "
        "than the step",
        "look for a load or an end that jumps, or for ends that pull the rod taut, which cannot stretch: keep them "
        "nearer to each other than its length; soften the contact law; or use more intervals, with a tolerance a "
        "smaller one",
        "solver",
    )
    ROD_CROSSED_ITSELF = (
        "rod_crossed_itself",
        "even at the smallest step it could not be ruled out that the rod passed through itself",
        "use more intervals or a smaller dt_max, with a tolerance a smaller one; or a finer contact.spacing or a "
        "stiffer contact law",
        "solver",
    )
    MESH_TOO_COARSE = (
        "mesh_too_coarse",
        "the rod bends or twists by more than half a turn from one node to the next, which no longer says how it "
        "lies",
        "use more intervals, with a tolerance a smaller one; or look for a load or an end that is far too strong for "
        "the rod; a limp rope that whips needs damping, or a retardation_time",
        "solver",
    )
    ROD_STRETCHED = (
        "rod_stretched",
        "the rod was no longer as long as it is by more than 10 %, or, with rod.axial_stiffness, 5 times as long or a "
        "fifth (with contact 1.5 times): its ends or loads pull or press it so far, or the box method did not keep the "
        "length of an interval",
        "keep the ends nearer to each other than 1.1 times the rod's length, or give it its rod.axial_stiffness, with "
        "which it stretches; if it has one, give a larger one; to a straight rod that is to buckle, give "
        "a small load across it, which says to which side; by the box method, use more intervals, a smaller dt_max or "
        "increment_tolerance, or the method staggered or a tolerance",
        "solver",
    )
    ENERGY_MADE = (
        "energy_made",
        "the equations keep energy, but more than a tenth of all that changed its form or hands came from nowhere",
        "with a tolerance use a smaller one; else more intervals where the section varies, a smaller dt_max or "
        "increment_tolerance, a smaller rho_inf, or the other method",
        "solver",
    )
    ENERGY_LOST = (
        "energy_lost",
        "the equations keep energy, but at t_end more than a tenth of all that changed its form or hands has gone "
        "nowhere, besides what an end took that was stopped or set going at once: the steps are too long for its "
        "waves",
        "with a tolerance use a smaller one; else a smaller dt_max or increment_tolerance, a larger rho_inf, or more "
        "intervals; or give the rod damping, if it is to come to rest",
        "solver",
    )
    SHOOTING_LOST_DIGITS = (
        "shooting_lost_digits",
        "shooting cannot resolve this rod at this step",
        "use linear_solver block_elimination, or a larger dt_max",
        "solver",
    )
    SINGULAR_SYSTEM = (
        "singular_system",
        "the linear system has no single solution",
        "check that the end conditions leave no motion undetermined: in statics a floor or an obstacle holds only what "
        "is in it at the start, so let a rod that rests on one begin a little below its surface, and a rod on one pin "
        "hangs, and an arch between two swings, only from loads that are there at the start; by the box method, a "
        "straight rod that is held along its axis at both ends needs the method staggered",
        "solver",
    )
    EQUILIBRIUM_LOST = (
        "equilibrium_lost",
        "statics: the branch of equilibria could not be followed",
        "where a symmetric rod buckles, add a small load that says to which side; look for ends that ask for more "
        "than the rod's length, or leave it free to swing or fall as a whole, as one pin does: then begin with a shape "
        "near its equilibrium; or let a damped dynamic run come to rest",
        "solver",
    )
    PATH_TURNED_BACK = (
        "path_turned_back",
        "statics: the branch of equilibria led back past the start of the schedules",
        "take a smaller t_end, or let what is driven begin beyond its start: a load with the other sign",
        "solver",
    )
    TOLERANCE_NOT_REACHED = (
        "tolerance_not_reached",
        "no run of the scene came to its end within the work that a tolerance may take; the dataset has the frames "
        "that it reached",
        "end earlier, damp waves that the loads or the start excite, or give intervals and dt_max instead of the "
        "tolerance",
        "solver",
    )
    WORKER_LOST = (
        "worker_lost",
        "its worker stopped answering, as often as HOCKLE_ATTEMPTS says, without getting any farther",
        "the case may need more memory than there is; try fewer frames or intervals, with a tolerance a larger "
        "one, and see the worker's log",
        "service",
    )
    WALL_TIME_EXCEEDED = (
        "wall_time_exceeded",
        "the job ran for longer than it may",
        "give it more, or fewer intervals or a larger dt_max, with a tolerance a larger one",
        "worker",
    )
    ESTIMATE_EXCEEDED = (
        "estimate_exceeded",
        "the run took many times the computing that was estimated for it (HOCKLE_OVERRUN says how many); the dataset "
        "has the frames that it reached",
        "give a dt_max and intervals that the motion needs, so that the estimate knows, or a tolerance; soften what "
        "makes steps short, as a small increment_tolerance or a stiff contact law; or end earlier",
        "worker",
    )
    OUT_OF_MEMORY = (
        "out_of_memory",
        "the job took more memory than it may, or than there is",
        "use a longer output.interval or fewer intervals, with a tolerance a larger one",
        "worker",
    )
    DISK_LIMIT_EXCEEDED = (
        "disk_limit_exceeded",
        "the job wrote more than it may",
        "give it more, or store less with output.fields or a longer output.interval",
        "worker",
    )
    DISK_FULL = (
        "disk_full",
        "the disk stayed full for ten minutes, and nothing of the run is kept",
        "make room and submit the case again",
        "worker",
    )
    DATASET_NOT_WRITTEN = (
        "dataset_not_written",
        "the dataset could not be written, or the object store could not be reached for ten minutes",
        "see the worker's log, and submit the case again",
        "worker",
    )
    INVALID_CASE = (
        "invalid_case",
        "the case was accepted, but cannot be built",
        "change what the message names, and submit the case again",
        "worker",
    )
    INTERNAL_ERROR = (
        "internal_error",
        "a fault of hockle",
        "report it with the case and the job's id; the worker's log says where it happened",
        "worker",
    )
