"""The rod of a case at t = 0."""

from __future__ import annotations

from math import hypot
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from service.cases.errors import refusal
from service.cases.quantities import LONGEST_TABLE, Profile, Spec, Triple, curve
from service.meaning import means
from solver import Initial

ORIGIN: Triple = (0.0, 0.0, 0.0)
LONGEST_AXIS = 1e100
"""Its square is finite. How long it is does not matter."""


class _Motion(Spec):
    """What both shapes have: how the section lies, and a rigid motion in the lab frame."""

    a1: Annotated[
        Triple | None,
        means(
            "lab direction of the first principal axis at s = 0, made normal to the rod there; not along it. None: e1, "
            "or e2 where the rod begins along e1"
        ),
    ] = None
    twist: Annotated[
        Profile, means("profile: turn of the section about the rod, beside parallel transport along it", "rad")
    ] = 0.0
    velocity: Annotated[Triple, means("lab, of the whole rod", "m/s")] = ORIGIN
    angular_velocity: Annotated[Triple, means("lab, about the centre of mass of the rod alone", "rad/s")] = ORIGIN

    def _common(self) -> dict[str, Any]:
        return {
            "a1": self.a1,
            "twist": curve(self.twist),
            "velocity": self.velocity,
            "angular_velocity": self.angular_velocity,
        }


class Straight(_Motion):
    """A straight rod from `origin` along `direction`, both in the lab frame."""

    shape: Annotated[Literal["straight"], means("which of the two shapes it is")]
    origin: Annotated[Triple, means("where s = 0 is", "m")] = ORIGIN
    direction: Annotated[Triple, means("along the rod, of any length > 0")] = (0.0, 0.0, 1.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not any(self.direction):
            raise refusal("direction", self.direction, "must not be zero")
        if self.a1 is None:
            return self
        (a, b, c), (x, y, z) = self.a1, self.direction
        across = hypot(b * z - c * y, c * x - a * z, a * y - b * x)
        if across <= 1e-6 * hypot(a, b, c) * hypot(x, y, z):
            raise refusal("a1", self.a1, f"must not be zero or along direction {self.direction}")
        return self

    def build(self, length: float) -> Initial:
        """The solver's initial state of a rod of any length."""
        return Initial.straight(self.origin, self.direction, **self._common())


class Centreline(_Motion):
    """A smooth curve through `points` (lab frame), as long as the rod to 0.1 %."""

    shape: Annotated[Literal["centreline"], means("which of the two shapes it is")]
    points: Annotated[
        tuple[Triple, ...],
        Field(min_length=4, max_length=LONGEST_TABLE),
        means("a smooth curve goes through them, as long as the rod to 0.1 %", "m"),
    ]

    @model_validator(mode="after")
    def _check(self) -> Self:
        for i in range(1, len(self.points)):
            if self.points[i] == self.points[i - 1]:
                raise refusal(f"points/{i}", self.points[i], "must differ from the point before it")
        if self.a1 is not None and not any(self.a1):
            raise refusal("a1", self.a1, "must not be zero")
        if self.a1 is not None and hypot(*self.a1) > LONGEST_AXIS:
            raise refusal("a1", self.a1, f"must be at most {LONGEST_AXIS:g} long")
        return self

    def build(self, length: float) -> Initial:
        """The solver's initial state. Raises ValueError if the curve is not `length` (m) long."""
        return Initial.through(np.array(self.points), length, **self._common())


def _shape(value: Any) -> str | None:
    shape = value.get("shape") if isinstance(value, dict) else getattr(value, "shape", None)
    return f"<{shape}>" if shape in ("straight", "centreline") else None


InitialSpec = Annotated[
    Annotated[Straight, Tag("<straight>")] | Annotated[Centreline, Tag("<centreline>")],
    Discriminator(
        _shape,
        custom_error_type="refused",
        custom_error_message="refused",
        custom_error_context={"at": "shape", "rule": "must be straight or centreline"},
    ),
]
