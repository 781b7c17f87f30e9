"""One line of the table: what was measured, what it should be, and by how much it may miss."""

from __future__ import annotations

from dataclasses import dataclass
from math import log2


@dataclass(frozen=True)
class Row:
    """A measured value beside its reference; `passed` if `error` is at most `aim`, and a NaN never passes."""

    name: str
    measured: float
    reference: float
    error: float
    aim: float

    @property
    def passed(self) -> bool:
        """Whether the aim is met."""
        return self.error <= self.aim


def against(name: str, measured: float, reference: float, aim: float) -> Row:
    """A value that may miss its reference by `aim`, in the value's own unit."""
    return Row(name, measured, reference, abs(measured - reference), aim)


def relative(name: str, measured: float, reference: float, aim: float) -> Row:
    """A value that may miss its reference by `aim` times the reference."""
    return Row(name, measured, reference, abs(measured / reference - 1.0), aim)


def at_most(name: str, measured: float, aim: float) -> Row:
    """A value that should be zero and may be at most `aim`."""
    return Row(name, measured, 0.0, abs(measured), aim)


def observed_order(name: str, coarse: float, fine: float) -> Row:
    """The order of convergence seen from the errors of two runs, the second of half the step: 2.0 +- 0.1."""
    return against(name, log2(coarse / fine) if coarse > 0 and fine > 0 else float("nan"), 2.0, 0.1)
