"""What a dataset holds: one table, from which the writer, the queries and the documentation derive."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.cases import CaseSpec
from solver import Frame, VerifiedFrame
from solver.run.verify import UNVERIFIED

ERROR = "_error"

LABELS: dict[str, tuple[str, ...]] = {
    "body": ("a1", "a2", "a3"),
    "lab": ("e1", "e2", "e3"),
    "quaternion": ("w", "x", "y", "z"),
}
"""The dimensions that count components, and the names of these."""

LABEL_NAMES = {
    "body": "axis of the material frame",
    "lab": "axis of the lab frame",
    "quaternion": "component of the unit quaternion",
}

COORDINATES: dict[str, dict[str, str]] = {
    "time": {
        "units": "seconds since 1970-01-01",
        "calendar": "standard",
        "units_metadata": "leap_seconds: none",
        "standard_name": "time",
        "axis": "T",
        "long_name": "time since the start of the simulation",
        "comment": "the date stands for the start; xarray gives seconds with decode_times=False",
    },
    "s": {"units": "m", "long_name": "arclength from the start of the rod"},
}
"""The attributes of the coordinates. CF knows time only as time since a date."""


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


def _along_rod(
    name: str, components: str, units: str, long_name: str, frame: Literal["material", "lab", ""]
) -> Variable:
    return Variable(name, ("time", "s", components), units, long_name, frame)


def _number(name: str, units: str, long_name: str, kind: Literal["f8", "i4"] = "f8") -> Variable:
    return Variable(name, ("time",), units, long_name, type=kind)


VARIABLES: tuple[Variable, ...] = (
    _along_rod("v", "body", "m s-1", "velocity of the centreline", "material"),
    _along_rod("omega", "body", "rad s-1", "angular velocity of the section", "material"),
    _along_rod("f", "body", "N", "internal force", "material"),
    _along_rod("kappa", "body", "rad m-1", "curvature and twist", "material"),
    _along_rod("q", "body", "N m", "internal moment", "material"),
    _along_rod("r", "lab", "m", "position of the centreline", "lab"),
    _along_rod("orientation", "quaternion", "1", "rotation from material to lab components", ""),
    _number("energy_bending", "J", "strain energy of bending"),
    _number("energy_torsion", "J", "strain energy of torsion"),
    _number("energy_kinetic", "J", "kinetic energy of the rod"),
    _number("energy_added_mass", "J", "kinetic energy of the added mass of fluid"),
    _number("energy_potential", "J", "potential energy of weight and buoyancy"),
    _number("energy_contact", "J", "potential energy of self-contact"),
    _number("work_ends", "J", "work of the ends since the start"),
    _number("work_loads", "J", "work of the loads since the start"),
    _number("dissipation", "J", "energy dissipated since the start"),
    _number("energy_balance", "J", "energy gained less work done plus energy dissipated, zero if exact"),
    _number("Tw", "turn", "twist"),
    _number("Wr", "turn", "writhe of the centreline continued by straight rays"),
    _number("Lk", "turn", "linking number, the relative rotation of the ends"),
    _number("min_gap", "m", "smallest gap between surfaces, once the total curvature does not rule contact out"),
    _number("contacts", "1", "number of point pairs that press on each other", "i4"),
    _number("dt", "s", "length of the time step that ended here"),
    _number("newton_iterations", "1", "Newton iterations of the time step that ended here", "i4"),
    Variable("parameter", ("time",), "s", "time in the schedules, which may go back", statics=True),
    Variable("negative_modes", ("time",), "1", "directions in which the energy falls, 0 if stable", "", "i4", True),
)


def _error_of(variable: Variable) -> Variable:
    long_name = f"estimated error of {variable.name}"
    told = replace(variable, name=variable.name + ERROR, long_name=long_name)
    return ErrorVariable(**vars(told))


ERRORS = {v.name: _error_of(v) for v in VARIABLES if v.name not in UNVERIFIED}
"""By the name of the variable whose error it is."""


def stored_variables(spec: CaseSpec) -> tuple[Variable, ...]:
    """The variables of a case's dataset: the fields that it asks for, and every number in time; errors if verified."""
    asked = (v for v in VARIABLES if not v.along_rod or v.name in spec.output.fields)
    stored = tuple(v for v in asked if spec.analysis == "static" or not v.statics)
    if not spec.numerics.verify:
        return stored
    errors = {v.name: ERRORS[v.name] for v in stored if v.name in ERRORS}
    return (*(replace(v, ancillary=errors[v.name].name) if v.name in errors else v for v in stored), *errors.values())
