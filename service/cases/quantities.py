"""Numbers, profiles along s and schedules in time, as a case writes them. SI units."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    GetJsonSchemaHandler,
    Tag,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from service.cases.errors import refusal
from service.meaning import means
from solver import Curve, Vector

LONGEST_TABLE = 10_000

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Triple = tuple[Finite, Finite, Finite]
"""Three components of a vector in the lab frame."""

FrameName = Literal["material", "lab"]
Interpolation = Literal["linear", "smoothstep", "pchip", "cubic"]
Column = Annotated[tuple[Finite, ...], Field(min_length=2, max_length=LONGEST_TABLE)]


class Spec(BaseModel):
    """A part of a case: strict, immutable, without unknown fields."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class ProfileTable(Spec):
    """A function of arclength s (m) through the points (s, value), constant beyond them."""

    s: Annotated[Column, means("arclengths, increasing strictly", "m")]
    value: Column
    interpolation: Interpolation

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_table("s", self.s, self.value)
        return self

    def curve(self) -> Curve:
        """The table as the solver's curve."""
        return Curve.table(self.s, self.value, self.interpolation)


class ScheduleTable(Spec):
    """A function of time t (s) through the points (t, value), constant before and after them."""

    t: Annotated[Column, means("times, increasing strictly", "s")]
    value: Column
    interpolation: Interpolation

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_table("t", self.t, self.value)
        return self

    def curve(self) -> Curve:
        """The table as the solver's curve."""
        return Curve.table(self.t, self.value, self.interpolation)


def check_table(name: str, x: tuple[float, ...], value: tuple[float, ...], of: str = "value") -> None:
    """Refuse a table whose x do not increase, or which has not as many values, in the field `of`."""
    if len(x) != len(value):
        raise refusal(of, len(value), f"must have as many entries as {name} ({len(x)})")
    for i in range(1, len(x)):
        if x[i] <= x[i - 1]:
            jump = ": where it jumps, let two points be close together" if x[i] == x[i - 1] else ""
            raise refusal(f"{name}/{i}", x[i], f"must be greater than the entry before it ({x[i - 1]}){jump}")


def number_or_table(value: Any) -> str:
    """The tag of a profile or schedule; tags stand in angle brackets, so that no pointer shows them."""
    return "<table>" if isinstance(value, (dict, ProfileTable, ScheduleTable)) else "<number>"


Profile = Annotated[
    Annotated[Finite, Tag("<number>")] | Annotated[ProfileTable, Tag("<table>")],
    Discriminator(number_or_table),
]
"""A property along the rod: a number, or a table in s."""


def _positive(profile: float | ProfileTable) -> float | ProfileTable:
    if isinstance(profile, ProfileTable):
        for i, value in enumerate(profile.value):
            if value <= 0:
                raise refusal(f"value/{i}", value, "must be > 0")
    elif profile <= 0:
        raise refusal("", profile, "must be > 0")
    return profile


class _PositiveSchema:
    """Says in the JSON schema of a profile that its number must be > 0."""

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = handler(core)
        for kind in schema.get("oneOf", []):
            if kind.get("type") == "number":
                kind["exclusiveMinimum"] = 0
        return schema


PositiveProfile = Annotated[Profile, AfterValidator(_positive), _PositiveSchema()]
"""A profile that is > 0; between the points of a table the solver's rod looks."""

Schedule = Annotated[
    Annotated[Finite, Tag("<number>")] | Annotated[ScheduleTable, Tag("<table>")],
    Discriminator(number_or_table),
]
"""A function of time: a number, or a table in t."""

ProfileTriple = tuple[Profile, Profile, Profile]
ScheduleTriple = tuple[Schedule, Schedule, Schedule]


@lru_cache(256)
def curve(function: float | ProfileTable | ScheduleTable) -> Curve:
    """A profile or schedule as the solver's curve; those used last are kept, as cases share most of theirs."""
    if isinstance(function, (int, float)):
        return Curve.constant(function + 0.0)  # -0.0 is kept as 0.0
    return function.curve()


def curves(functions: ProfileTriple | ScheduleTriple) -> Vector:
    """Three profiles or schedules as the solver's curves."""
    first, second, third = functions
    return curve(first), curve(second), curve(third)
