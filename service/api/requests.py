"""What a client asks for when it submits or validates: a case, and how it wants it run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

from fastapi import Depends
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError, WithJsonSchema

from service.api.bodies import json_object
from service.cases import CaseError, CaseSpec, FieldError, apply_settings, load_case, parse_case, shipped_cases
from service.jobs import Limits
from service.jobs.job import LEAST_MEMORY

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
    """What a job may use before it is ended by name, where that is to be less than the operator allows.

    `wall`: seconds of running; `memory` and `disk`: bytes.
    """

    model_config = ConfigDict(extra="forbid", strict=True)
    wall: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    memory: Annotated[int, Field(ge=LEAST_MEMORY)] | None = None
    disk: Annotated[int, Field(gt=0)] | None = None

    def within(self, most: Limits) -> Limits:
        """The limits that the job gets. Raises CaseError for those beyond `most`."""
        asked = self.model_dump(exclude_none=True)
        beyond = [FieldError(f"/limits/{name}", value, f"must be <= {getattr(most, name):g}, which this service allows")
                  for name, value in asked.items() if value > getattr(most, name)]
        if beyond:
            raise CaseError(beyond)
        return replace(most, **asked)


class JobRequest(BaseModel):
    """A case with what belongs to its job, not to its physics.

    `case`: a whole case, or the name of a shipped one; `set`: values to change in it, by dotted key.
    """

    model_config = ConfigDict(extra="forbid", strict=True)
    case: CaseOrName
    set: dict[str, Any] = {}
    label: Annotated[str, Field(max_length=100, pattern=r"^[^\x00-\x1f\x7f]*$")] = ""
    priority: Annotated[int, Field(ge=-100, le=100)] = 0
    webhook: Annotated[str, Field(max_length=2000, pattern="^https?://")] | None = None
    reuse: bool = True
    limits: LimitsRequest = LimitsRequest()


@dataclass(frozen=True)
class Wanted:
    """A request understood: the case that will run, and the rest of the request."""

    spec: CaseSpec
    told: JobRequest


def wanted(body: Annotated[dict[str, Any], Depends(json_object)]) -> Wanted:
    """What a body asks for: a JobRequest, or a bare case. Raises CaseError.

    Pointers lead into the body; those of a shipped case, which is not in the body, lead into the case.
    """
    if "case" not in body:
        return Wanted(parse_case(body), JobRequest(case=body))
    try:
        told = JobRequest.model_validate(body)
    except ValidationError as error:
        raise CaseError.of(error) from None
    if isinstance(told.case, str):
        if told.case not in SHIPPED:  # a name only: never a path
            raise CaseError([FieldError("/case", told.case, f"must be one of {', '.join(SHIPPED)}")])
        return Wanted(parse_case(apply_settings(load_case(told.case), told.set)), told)
    try:
        return Wanted(parse_case(apply_settings(told.case, told.set)), told)
    except CaseError as error:
        inside = [FieldError(f"/case{fault.pointer}", fault.value, fault.rule) for fault in error.errors]
        raise CaseError(inside) from None


InWanted = Annotated[Wanted, Depends(wanted)]
