"""In which format a client wants numbers: by `format` in the query, or else by the Accept header."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any, Literal, Self

from fastapi import Header, Response
from pydantic import BaseModel, ConfigDict, Field, model_validator

from service.api.numbers import WHOLE
from service.api.problems import Problem
from service.cases.errors import refusal
from service.results import NoFrames, Ranges, SubsetTooLarge, UnknownVariable
from service.results.formats import FORMATS, Format
from service.results.part import Part

FormatName = Literal["json", "csv", "netcdf", "arrow"]
Accept = Annotated[str | None, Header(alias="Accept", description="A format's media type, where the query has none")]
WEIGHT = re.compile(r"(?:^|;)\s*[qQ]\s*=\s*(0(?:\.\d{0,3})?|1(?:\.0{0,3})?)\s*(?:;|$)")
"""How much a media type is wanted, among its parameters."""
ALSO = {"application/netcdf": "netcdf", "application/vnd.apache.arrow.file": "arrow"}
CONTENT: dict[int | str, dict[str, Any]] = {200: {"description": "The values", "content": {
    form.media_type: {"schema": {"type": "object"} if name == "json" else {"type": "string", "format": "binary"}}
    for name, form in FORMATS.items()}}}  # fmt: skip
"""The formats in an operation's `responses`."""


class Variables(BaseModel):
    """Which variables are wanted, and how."""

    model_config = ConfigDict(extra="forbid")
    variables: str = Field(min_length=1, max_length=1000, examples=["Tw,Wr,Lk"])
    format: FormatName | None = Field(None, description="Else as the Accept header says; JSON if it says nothing")

    @property
    def names(self) -> list[str]:
        """The variables by name."""
        return [name.strip() for name in self.variables.split(",")]


class VariablesInRanges(Variables):
    """Which part of a dataset: names with commas between, ranges in s and m, every n-th in time and s."""

    t_min: float | None = Field(None, allow_inf_nan=False)
    t_max: float | None = Field(None, allow_inf_nan=False)
    s_min: float | None = Field(None, allow_inf_nan=False)
    s_max: float | None = Field(None, allow_inf_nan=False)
    time_stride: Annotated[int, Field(ge=1), WHOLE] = 1
    s_stride: Annotated[int, Field(ge=1), WHOLE] = 1

    @model_validator(mode="after")
    def _check(self) -> Self:
        for low, high in (("t_min", "t_max"), ("s_min", "s_max")):
            least, most = getattr(self, low), getattr(self, high)
            if least is not None and most is not None and most < least:
                raise refusal(high, most, f"must be >= {low}, which is {least}")
        return self

    @property
    def ranges(self) -> Ranges:
        """The ranges alone."""
        return Ranges(**self.model_dump(exclude={"variables", "format"}))


def format_of(name: FormatName | None, accept: str | None) -> tuple[str, Format]:
    """The format that is asked for, with its name: the one accepted most, as RFC 9110 has it, and of equals the one
    named first. JSON where none of ours is."""
    chosen = name or _accepted(accept or "*/*")
    return chosen, FORMATS[chosen]


def _accepted(accept: str) -> str:
    weights = {kind.strip().lower(): _weight(parameters) for kind, _, parameters in
               (part.partition(";") for part in accept.split(","))}  # fmt: skip
    types = {form.media_type: key for key, form in FORMATS.items()} | ALSO

    def wanted(kind: str) -> float:
        return next((weights[range_] for range_ in (kind, f"{kind.partition('/')[0]}/*", "*/*") if range_ in weights),
                    0.0)  # the narrowest range says it

    best = max([*(kind for kind in weights if kind in types), *types], key=wanted)
    return types[best] if wanted(best) > 0.0 else "json"


def _weight(parameters: str) -> float:
    weight = WEIGHT.search(parameters)
    return float(weight[1]) if weight else 1.0


@contextmanager
def readable() -> Iterator[None]:
    """While a part is read. Raises Problem 404, 422."""
    try:
        yield
    except SubsetTooLarge as error:
        raise Problem(422, "subset_too_large", str(error)) from None
    except NoFrames as error:
        raise Problem(404, "no_frames", str(error)) from None
    except UnknownVariable as error:
        raise Problem(422, "unknown_variable", str(error)) from None


def response_of(part: Part, form: Format, headers: dict[str, str] | None = None) -> Response:
    """The response that holds a part."""
    return Response(form.write(part), 200, {"Vary": "Accept"} | (headers or {}), form.media_type)
