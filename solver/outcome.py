"""How a run that could not go on says so. The outcomes themselves, with their remedies, are one table: `outcomes`."""

from __future__ import annotations

from outcomes import Outcome

__all__ = ["Outcome", "RunFailed"]


class RunFailed(Exception):
    """A run that could not go on: its outcome, where it stopped, and what to do about it."""

    def __init__(self, outcome: Outcome, t: float, step: int, detail: str = "") -> None:
        super().__init__(outcome, t, step, detail)
        self.outcome, self.t, self.step, self.detail = outcome, t, step, detail

    def __str__(self) -> str:
        outcome, detail = self.outcome, f" ({self.detail})" if self.detail else ""
        return f"{outcome.value} at t = {self.t:.6g} s, step {self.step}{detail}: {outcome.meaning}: {outcome.remedy}"
