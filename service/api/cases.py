"""/v1/cases: the shipped cases and the schema; /v1/validate: a case looked at, not run."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Depends
from pydantic import BaseModel

from service.api.bodies import json_object
from service.api.problems import Problem
from service.cases import (
    CaseError,
    CaseSpec,
    FieldError,
    apply_settings,
    case_schema,
    load_case,
    parse_case,
    shipped_cases,
)

router = APIRouter(prefix="/v1", tags=["cases"])

SHIPPED_WITH_SETTINGS = {
    "type": "object",
    "title": "A shipped case, with settings by dotted key",
    "properties": {"case": {"type": "string"}, "set": {"type": "object"}},
    "required": ["case"],
    "additionalProperties": False,
    "examples": [{"case": "goyal-2003", "set": {"t_end": 34, "numerics.intervals": 400}}],
}
WHOLE_CASE = {"type": "object", "title": "A whole case", "description": "As /v1/cases/schema tells."}
CASE_BODY = {"requestBody": {"required": True, "content": {"application/json": {
    "schema": {"oneOf": [WHOLE_CASE, SHIPPED_WITH_SETTINGS]}}}}}


class Verdict(BaseModel):
    """A case that could be run: as it was understood, and how much it would store."""

    case: dict[str, Any]
    nodes: int
    frames: int


def told_case(body: Annotated[dict[str, Any], Depends(json_object)]) -> CaseSpec:
    """The case in a request: a whole one, or {"case": a shipped name, "set": {dotted key: value}}.

    Raises CaseError.
    """
    return parse_case(_shipped_with_settings(body) if "case" in body else body)


@router.post("/validate", openapi_extra=CASE_BODY)
def validate(spec: Annotated[CaseSpec, Depends(told_case)]) -> Verdict:
    """Look at a case as a submission would, and say what it asks for."""
    return Verdict(case=spec.document(), nodes=spec.numerics.intervals + 1, frames=spec.frames)


@router.get("/cases")
def list_cases() -> dict[str, str]:
    """Name and title of each shipped case."""
    return shipped_cases()


@router.get("/cases/schema")
def schema() -> dict[str, Any]:
    """The JSON schema of a case."""
    return case_schema()


@router.get("/cases/{name}")
def shipped_case(name: str) -> dict[str, Any]:
    """A shipped case, ready to be changed and submitted."""
    if name not in shipped_cases():  # a name only: never a path
        raise Problem(404, "unknown_case", f"there is no shipped case {name[:80]!r}: see /v1/cases")
    return load_case(name)


def _shipped_with_settings(body: dict[str, Any]) -> dict[str, Any]:
    name, settings = body["case"], body.get("set", {})
    faults = [FieldError(f"/{key}", None, "is not a field beside case and set")
              for key in body if key not in ("case", "set")]
    if not (isinstance(name, str) and name in shipped_cases()):
        faults.append(FieldError("/case", name, f"must be one of {', '.join(shipped_cases())}"))
    if not isinstance(settings, dict):
        faults.append(FieldError("/set", settings, "must be an object of dotted keys and values"))
    if faults:
        raise CaseError(faults)
    return apply_settings(load_case(name), settings)
