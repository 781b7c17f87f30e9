"""What a client asks for when it submits or validates: a case, and how it wants it run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, Self

from fastapi import Depends
from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    WithJsonSchema,
    model_validator,
)

from service.api.bodies import json_object
from service.cases import CaseError, CaseSpec, FieldError, apply_settings, load_case, parse_case, shipped_cases
from service.cases.errors import refusal
from service.cases.suggestions import suggested
from service.jobs import Limits
from service.jobs.job import LEAST_MEMORY
from service.meaning import NO_CONTROL, means

SHIPPED = tuple(shipped_cases())


def _name_or_whole(value: Any) -> str:
    """The tag of a case; tags stand in angle brackets, so that no pointer shows them."""
    return "<whole>" if isinstance(value, dict) else "<name>"


CaseOrName = Annotated[
    Annotated[str, Tag("<name>")] | Annotated[dict[str, Any], Tag("<whole>")],
    Discriminator(_name_or_whole),
    WithJsonSchema({"anyOf": [{"enum": list(SHIPPED)}, {"$ref": "#/components/schemas/CaseSpec"}]}),
]


class LimitsRequest(BaseModel):
    """What a job may use before it is ended by name, where that is to be less than the operator allows."""

    model_config = ConfigDict(extra="forbid", strict=True)
    wall: Annotated[
        Annotated[float, Field(gt=0, allow_inf_nan=False)] | None, means("the longest that it may run", "s")
    ] = None
    memory: Annotated[Annotated[int, Field(ge=LEAST_MEMORY)] | None, means("the most memory", "bytes")] = None
    disk: Annotated[Annotated[int, Field(gt=0)] | None, means("the most disk", "bytes")] = None

    def within(self, most: Limits) -> Limits:
        """The limits that the job gets. Raises CaseError for those beyond `most`."""
        limits = {name: value for name, value in self if value is not None}
        beyond = [FieldError(f"/limits/{name}", value, f"must be <= {getattr(most, name):g}, which this service allows")
                  for name, value in limits.items() if value > getattr(most, name)]
        if beyond:
            raise CaseError(beyond)
        return replace(most, **limits)


class ForkRequest(BaseModel):
    """Other conditions of a job's ends from a time on: a switch in place of all that would come later."""

    model_config = ConfigDict(extra="forbid", strict=True)
    at: Annotated[Annotated[float, Field(gt=0, allow_inf_nan=False)], means("the time", "s")]
    start: Annotated[dict[str, Any], means("conditions at s = 0, as `omega3`, as a switch has them")] = {}
    end: Annotated[dict[str, Any], means("conditions at s = L")] = {}

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not (self.start or self.end):
            raise refusal("end", None, "is required, or start: what is otherwise from then on")
        return self

    def applied(self, case: Mapping[str, Any]) -> dict[str, Any]:
        """A case with these."""
        ends = {name: _switched(end, self.at, getattr(self, name)) for name, end in case["ends"].items()}
        return {**case, "ends": ends}


def _switched(end: Any, at: float, conditions: Mapping[str, Any]) -> Any:
    if not conditions:
        return end
    before: dict[str, Any] = {"preset": end} if isinstance(end, str) else end
    earlier = [switch for switch in before.get("switches", ()) if switch["at"] < at]
    return {**before, "switches": [*earlier, {"at": at, **conditions}]}


class JobRequest(BaseModel):
    """A case, or another job's case, with what belongs to its job, not to its physics."""

    model_config = ConfigDict(extra="forbid", strict=True)
    case: Annotated[CaseOrName | None, means("a whole case, or the name of a shipped one")] = None
    job: Annotated[
        Annotated[str, Field(pattern="^[0-9a-z]{26}$")] | None,
        means("instead of `case`: a job of yours, whose case it is. Until something differs the two are one run, and "
              "the new one begins where the other had come by then"),
    ] = None  # fmt: skip
    fork: Annotated[
        ForkRequest | None, means("with `job`: a time from which on its ends are moved otherwise")
    ] = None
    set: Annotated[dict[str, Any], means("values to change in it, by dotted key")] = {}
    label: Annotated[
        str, Field(max_length=100, pattern=NO_CONTROL), means("a word of yours to find the job by")
    ] = ""
    priority: Annotated[int, Field(ge=-100, le=100), means("of your own waiting jobs the highest goes first")] = 0
    webhook: Annotated[
        Annotated[str, Field(max_length=2000, pattern="^https?://")] | None,
        means("an address that is sent the job's end"),
    ] = None
    reuse: Annotated[
        bool,
        means("a job of yours that has run the same case is the answer (status 200) instead of a new one"),
    ] = True
    limits: Annotated[
        LimitsRequest,
        means("any of `wall` (s of running), `memory` and `disk` (bytes), beyond which the job is ended by name; no "
              "more than the operator allows"),
    ] = LimitsRequest()  # fmt: skip


BARE = JobRequest()
"""What a bare case is handed in with."""


@dataclass(frozen=True)
class ParsedRequest:
    """A request understood: the case that will run, and the rest of the request."""

    spec: CaseSpec
    request: JobRequest


def parse_request(body: Annotated[dict[str, Any], Depends(json_object)]) -> ParsedRequest:
    """What a body asks for: a JobRequest, or a bare case. Raises CaseError.

    Pointers lead into the body; those of a shipped case, which is not in the body, lead into the case.
    """
    if "case" not in body:
        return ParsedRequest(parse_case(body), BARE)
    try:
        request = JobRequest.model_validate(body)
    except ValidationError as error:
        raise suggested(CaseError.of(error), JobRequest) from None
    if request.case is None or request.job is not None or request.fork is not None:
        raise CaseError([FieldError("/case", None, "is required, and neither job nor fork beside it")])
    if isinstance(request.case, str):
        if request.case not in SHIPPED:  # a name only: never a path
            raise CaseError([FieldError("/case", request.case, f"must be one of {', '.join(SHIPPED)}")])
        return ParsedRequest(parse_case(apply_settings(load_case(request.case), request.set)), request)
    try:
        return ParsedRequest(parse_case(apply_settings(request.case, request.set)), request)
    except CaseError as error:
        inside = [FieldError(f"/case{fault.pointer}", fault.value, fault.rule) for fault in error.errors]
        raise CaseError(inside, error.more) from None


InRequest = Annotated[ParsedRequest, Depends(parse_request)]
