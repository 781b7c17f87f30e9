"""A case, schema version 1: everything that a simulation is told, as its file or request says it."""

from __future__ import annotations

from math import ceil
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from service.cases.ends import EndsSpec
from service.cases.errors import refusal
from service.cases.initial import InitialSpec
from service.cases.quantities import Positive, Spec
from service.cases.rod import RodSpec
from service.cases.surroundings import ContactSpec, FluidSpec, LoadsSpec
from solver import Numerics

FieldName = Literal["v", "omega", "f", "kappa", "q", "r", "orientation"]
ALL_FIELDS: tuple[FieldName, ...] = ("v", "omega", "f", "kappa", "q", "r", "orientation")

MOST_NODE_FRAMES = 10_000_000
"""Nodes times stored frames: about 1.8 GB before compression."""

MOST_STEPS = 10_000_000
"""Steps at dt_max; the run may need more, where it has to refine."""

Fraction = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]


class NumericsSpec(Spec):
    """How the equations are solved: see `solver.Numerics`."""

    method: Literal["box", "staggered"] = "box"
    linear_solver: Literal["block_elimination", "shooting"] = "block_elimination"
    intervals: Annotated[int, Field(ge=2, le=20_000)] = 200
    dt_max: Positive = 0.05
    rho_inf: Fraction = 0.5
    rho_inf_space: Fraction = 1.0
    increment_tolerance: Positive = 0.1

    def build(self) -> Numerics:
        """The solver's settings."""
        return Numerics(**self.model_dump())


class OutputSpec(Spec):
    """A frame each `interval` (s), with the `fields` along the rod that are stored (all by default).

    `topology`: whether Wr and Lk are computed.
    """

    interval: Positive
    fields: Annotated[tuple[FieldName, ...], Field(min_length=1)] = ALL_FIELDS
    topology: bool = True

    @model_validator(mode="after")
    def _check(self) -> Self:
        for i, name in enumerate(self.fields):
            if name in self.fields[:i]:
                raise refusal(f"fields/{i}", name, "must be named once only")
        return self


class CaseSpec(Spec):
    """One case. All quantities in SI units; s is the arclength from the start, t the time."""

    schema_version: Annotated[int, Field(ge=1, le=1)]  # a Literal would take true for 1
    analysis: Literal["dynamic", "static"] = "dynamic"
    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=80)] = "unnamed"
    title: Annotated[str, Field(max_length=200)] = ""
    description: Annotated[str, Field(max_length=5000)] = ""
    rod: RodSpec
    initial: InitialSpec
    ends: EndsSpec
    fluid: FluidSpec | None = None
    loads: LoadsSpec = LoadsSpec()
    contact: ContactSpec | None = None
    numerics: NumericsSpec = NumericsSpec()
    t_end: Positive
    output: OutputSpec

    @property
    def frames(self) -> int:
        """How many frames the run yields, the one at t = 0 included."""
        return ceil(self.t_end / self.output.interval * (1 - 1e-12)) + 1

    def document(self) -> dict[str, Any]:
        """The case as plain JSON data, with every default filled in; `parse_case` gives it back."""
        return self.model_dump(mode="json", exclude_none=True)

    @model_validator(mode="after")
    def _check_positions(self) -> Self:
        for i, load in enumerate(self.loads.point):
            if load.s > self.rod.length:
                rule = f"must be <= the rod's length of {self.rod.length} m"
                raise refusal(f"loads/point/{i}/s", load.s, rule)
        return self

    @model_validator(mode="after")
    def _check_statics(self) -> Self:
        if self.analysis == "static" and self.contact is not None:
            raise refusal("contact", None, "must not be given with analysis static")
        return self

    @model_validator(mode="after")
    def _check_size(self) -> Self:
        if self.output.interval > self.t_end:
            raise refusal("output/interval", self.output.interval, f"must be <= t_end ({self.t_end} s)")
        stored = self.frames * (self.numerics.intervals + 1)
        if stored > MOST_NODE_FRAMES:
            rule = f"must leave at most {MOST_NODE_FRAMES:,} nodes times frames, not {stored:,}"
            raise refusal("output/interval", self.output.interval, rule)
        steps = self.t_end / self.numerics.dt_max
        if self.analysis == "dynamic" and steps > MOST_STEPS:
            rule = f"must leave at most {MOST_STEPS:,} steps, not {steps:,.0f}"
            raise refusal("numerics/dt_max", self.numerics.dt_max, rule)
        return self
