"""/v1/cases: the shipped cases and the schema; /v1/validate: a case looked at, not run."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path
from pydantic import BaseModel

from service.api.description import CASE_BODY, problems
from service.api.parts import InParts, Reader, Submitter
from service.api.problems import Problem
from service.api.requests import SHIPPED, InRequest
from service.cases import build_scene, case_schema, check_cost, estimate, load_case, shipped_cases, warnings_of

router = APIRouter(prefix="/v1", tags=["cases"])


class CostDocument(BaseModel):
    """An estimate made before the run: `seconds` of one core, `bytes` before compression."""

    nodes: int
    frames: int
    steps: int
    seconds: float
    bytes: int


class WarningDocument(BaseModel):
    """What is likely a slip: where (JSON pointer into the case), what stands there, and what speaks against it."""

    pointer: str
    value: Any
    rule: str


class Verdict(BaseModel):
    """A case that could be run: as it was understood, what it would cost, and what should be looked at again."""

    case: dict[str, Any]
    cost: CostDocument
    warnings: list[WarningDocument]


@router.post("/validate", openapi_extra=CASE_BODY, responses=problems(400, 413, 415, 422))
def validate(_: Submitter, parsed: InRequest, parts: InParts) -> Verdict:
    """The case as understood, its `cost` (nodes, frames, steps, seconds, bytes) and `warnings`. Nothing is run."""
    check_cost(parsed.spec, parts.settings.longest_run)
    parsed.request.limits.within(parts.settings.limits)
    warnings = [WarningDocument(**vars(warning)) for warning in warnings_of(parsed.spec, build_scene(parsed.spec))]
    return Verdict(case=parsed.spec.document(), cost=CostDocument(**vars(estimate(parsed.spec))), warnings=warnings)


@router.get("/cases")
def list_cases(_: Reader) -> dict[str, str]:
    """Name and title of each shipped case."""
    return shipped_cases()


@router.get("/cases/schema")
def schema(_: Reader) -> dict[str, Any]:
    """The JSON schema of a case."""
    return case_schema()


@router.get("/cases/{name}", responses=problems(404))
def shipped_case(name: Annotated[str, Path(examples=list(SHIPPED))], _: Reader) -> dict[str, Any]:
    """A shipped case, ready to be changed and submitted."""
    if name not in SHIPPED:  # a name only: never a path
        raise Problem(404, "unknown_case", f"there is no shipped case {name[:80]!r}: see /v1/cases")
    return load_case(name)
