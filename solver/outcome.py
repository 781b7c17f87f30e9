"""How a run ended: one name, and the sentence that the user reads."""

from __future__ import annotations

from enum import StrEnum


class Outcome(StrEnum):
    """Every way in which a run can end."""

    COMPLETED = "completed"
    CANCELLED = "cancelled"
    NO_CONSISTENT_START = "no_consistent_start"
    STEP_TOO_SMALL = "step_too_small"
    ROD_CROSSED_ITSELF = "rod_crossed_itself"
    MESH_TOO_COARSE = "mesh_too_coarse"
    ROD_STRETCHED = "rod_stretched"
    ENERGY_MADE = "energy_made"
    ENERGY_LOST = "energy_lost"
    SHOOTING_LOST_DIGITS = "shooting_lost_digits"
    SINGULAR_SYSTEM = "singular_system"
    EQUILIBRIUM_LOST = "equilibrium_lost"
    PATH_TURNED_BACK = "path_turned_back"
    TOLERANCE_NOT_REACHED = "tolerance_not_reached"


REMEDY: dict[Outcome, str] = {
    Outcome.COMPLETED: "",
    Outcome.CANCELLED: "submit the case again to run it to its end",
    Outcome.NO_CONSISTENT_START: (
        "no forces were found with which the rod could start: do not hold or drive a straight rod, which cannot "
        "stretch, along its axis at both ends; let loads and ends begin gently; or use more intervals"
    ),
    Outcome.STEP_TOO_SMALL: (
        "no step was short enough: look for a load or an end that jumps, soften the contact law, or use "
        "more intervals"
    ),
    Outcome.ROD_CROSSED_ITSELF: (
        "the rod passed through itself: use more intervals, a finer contact spacing, a stiffer contact law, "
        "or a smaller dt_max"
    ),
    Outcome.MESH_TOO_COARSE: (
        "the rod bends or twists by more than half a turn from one node to the next, which no longer says how it lies: "
        "use more intervals, or look for a load or an end that is far too strong for the rod"
    ),
    Outcome.ROD_STRETCHED: (
        "the rod, which cannot stretch, was no longer as long as it is: use more intervals, a smaller dt_max or "
        "increment_tolerance, or the method staggered, which keeps the length whatever happens"
    ),
    Outcome.ENERGY_MADE: (
        "the equations keep energy, but the numbers made it: use more intervals where the section varies, a smaller "
        "dt_max or increment_tolerance, a smaller rho_inf, or the other method"
    ),
    Outcome.ENERGY_LOST: (
        "the equations keep energy, but the steps took it from waves that they are too long for: use a smaller dt_max "
        "or increment_tolerance, a larger rho_inf, or more intervals; or give the rod damping, if it is to come to rest"
    ),
    Outcome.SHOOTING_LOST_DIGITS: (
        "shooting cannot resolve this rod at this step: use linear_solver block_elimination, or a larger dt_max"
    ),
    Outcome.SINGULAR_SYSTEM: (
        "the linear system is singular: check that the end conditions leave no motion undetermined, and that a "
        "straight rod, which cannot stretch, is not held along its axis at both ends"
    ),
    Outcome.EQUILIBRIUM_LOST: (
        "the branch of equilibria could not be followed: where a symmetric rod buckles, add a small load that says to "
        "which side; look for ends that ask for more than the rod's length; or let a damped dynamic run come to rest"
    ),
    Outcome.PATH_TURNED_BACK: (
        "the branch of equilibria led back past the start of the schedules: take a smaller t_end, or begin the "
        "schedules earlier"
    ),
    Outcome.TOLERANCE_NOT_REACHED: (
        "pilot runs found no mesh and steps that keep the tolerance: take a larger tolerance, damp waves that the "
        "loads or the start excite, or give intervals and dt_max instead of the tolerance"
    ),
}


class RunFailed(Exception):
    """A run that could not go on: its outcome, where it stopped, and what to do about it."""

    def __init__(self, outcome: Outcome, t: float, step: int, detail: str = "") -> None:
        super().__init__(outcome, t, step, detail)
        self.outcome, self.t, self.step, self.detail = outcome, t, step, detail

    def __str__(self) -> str:
        told = f" ({self.detail})" if self.detail else ""
        return f"{self.outcome.value} at t = {self.t:.6g} s, step {self.step}{told}: {REMEDY[self.outcome]}"
