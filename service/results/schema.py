"""What a dataset holds: the solver's outputs as variables, from which the writer, the queries and the guide derive."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.cases import CaseSpec
from solver import Frame, VerifiedFrame
from solver.measures.frame import OUTPUTS
from solver.measures.output import Output

ERROR = "_error"

LABELS: dict[str, tuple[str, ...]] = {
    "body": ("a1", "a2", "a3"),
    "lab": ("e1", "e2", "e3"),
    "quaternion": ("w", "x", "y", "z"),
}
"""The dimensions that count components, and the names of these."""

COMPONENTS: dict[str, tuple[str, ...]] = {
    "": (), "material": ("body",), "lab": ("lab",), "quaternion": ("quaternion",),
}  # fmt: skip
"""The dimension of an output's components, by its axes."""

LABEL_NAMES = {
    "body": "axis of the material frame",
    "lab": "axis of the lab frame",
    "quaternion": "component of the unit quaternion",
}

COORDINATES: dict[str, dict[str, str]] = {
    "time": {"units": "s", "long_name": "time since the start of the simulation"},
    "s": {"units": "m", "long_name": "arclength from the start of the rod"},
}
"""The attributes of the coordinates.

Time is a number of seconds as any other: xarray makes dates of units with "since", older ones durations of "seconds".
CF's standard name and axis of time ask for "since" (docs/decisions/0018-time-in-seconds.md).
"""


@dataclass(frozen=True)
class Variable:
    """One variable of the dataset; its name is also the attribute of `solver.Frame` that it stores.

    `ancillary`: the name of the variable that tells its error, if one is stored.
    """

    name: str
    dimensions: tuple[str, ...]
    units: str
    long_name: str
    frame: Literal["material", "lab", ""] = ""
    type: Literal["f8", "i4"] = "f8"
    statics: bool = False
    """Whether only a static analysis has it."""
    ancillary: str = ""

    @property
    def along_rod(self) -> bool:
        """Whether it has a value at each node."""
        return "s" in self.dimensions

    def of(self, frame: Frame) -> NDArray[np.float64] | float | int:
        """Its value in one frame."""
        value: NDArray[np.float64] | float | int = getattr(frame, self.name)
        return value


@dataclass(frozen=True)
class ErrorVariable(Variable):
    """The estimate of another variable's error, which the frames of a verified run have."""

    def of(self, frame: Frame) -> NDArray[np.float64] | float | int:
        """Its value in one frame."""
        if not isinstance(frame, VerifiedFrame):
            raise TypeError(f"{self.name} is of a verified run, got the frame of another")
        value: NDArray[np.float64] | float | int = getattr(frame.error, self.name.removesuffix(ERROR))
        return value


def _variable(output: Output) -> Variable:
    dimensions = ("time", *(("s",) if output.along_rod else ()), *COMPONENTS[output.axes])
    frame = "" if output.axes == "quaternion" else output.axes
    return Variable(output.name, dimensions, output.units, output.long_name, frame, output.type, output.statics)


VARIABLES = tuple(_variable(output) for output in OUTPUTS)


def _error_of(variable: Variable) -> Variable:
    long_name = f"estimated error of {variable.name}"
    error = replace(variable, name=variable.name + ERROR, long_name=long_name)
    return ErrorVariable(**vars(error))


ERRORS = {o.name: _error_of(v) for o, v in zip(OUTPUTS, VARIABLES, strict=True) if o.verified}
"""By the name of the variable whose error it is."""


def stored_variables(spec: CaseSpec) -> tuple[Variable, ...]:
    """The variables of a case's dataset: the fields that it asks for, and every number in time; errors if verified."""
    selected = (v for v in VARIABLES if not v.along_rod or v.name in spec.output.fields)
    stored = tuple(v for v in selected if spec.analysis == "static" or not v.statics)
    if not spec.numerics.has_errors:
        return stored
    errors = {v.name: ERRORS[v.name] for v in stored if v.name in ERRORS}
    return (*(replace(v, ancillary=errors[v.name].name) if v.name in errors else v for v in stored), *errors.values())
