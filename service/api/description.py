"""The OpenAPI document: what FastAPI finds, with the problems and the case's schema that it cannot know of."""

from __future__ import annotations

from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel, ConfigDict, Field
from pydantic.json_schema import models_json_schema

from service.api.designs import EnsembleRequest
from service.api.requests import JobRequest
from service.cases import CaseSpec

PROBLEM = {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}
ANYWHERE = (421,)
WITH_A_KEY = (401, 403, 429)
BEFORE_THE_LIMIT = {"401", "403", "421"}  # the gate refuses before it counts; too few scopes are found after
REF = "#/components/schemas/{model}"
NOT_OURS = ("HTTPValidationError", "ValidationError")

PARAMETERS = {
    "job_id": "The id that the submission was answered with",
    "ensemble_id": "The id that the submission of the ensemble was answered with",
    "key": "A key of the store, such as zarr.json or r/c/0/0/0",
    "process_id": "`simulate`: there is no other",
    "name": "A shipped case",
    "link_id": "A link, as the list of them names it",
    "token": "What the link was answered with",
    "what": "The structure (dds), the attributes (das) or the values (dods)",
    "Idempotency-Key": "The same key and body give the same job for a day, also if the first answer was lost",
    "Last-Event-ID": "The version of the job that was seen last: what came after it is sent",
    "limit": "At most so many on a page",
    "after": "Only what is older than this id: pages lead on with it",
    "status": "Only jobs of this status",
    "label": "Only jobs with exactly this label",
    "format": "In which format; else as the Accept header says",
    "variables": "Names of variables, with commas between them",
    "t_min": "Frames from this time on, s",
    "t_max": "Frames up to this time, s",
    "s_min": "Nodes from this arclength on, m",
    "s_max": "Nodes up to this arclength, m",
    "time_stride": "Each so many-th of these frames",
    "s_stride": "Each so many-th of these nodes",
}
"""What a parameter means wherever it occurs, unless its route says more."""

NOT_MODIFIED: dict[int | str, dict[str, Any]] = {304: {"description": "Unchanged since the ETag in If-None-Match"}}

SUMMARY = """\
Simulations of elastic rods as jobs: submit a case, follow the job, fetch its NetCDF dataset.

Every error is a problem (RFC 9457); where a case or a parameter is refused, `errors` says which, and by what rule.
Where a key is required, send `Authorization: Bearer hk_...`: a key sees its owner's jobs, and others' are not there."""

HEADERS = {401: {"WWW-Authenticate": "`Bearer`"}, 429: {"Retry-After": "Seconds to wait"}}
LIMITS = {"RateLimit-Policy": "How many requests an owner may make, and in how many seconds",
          "RateLimit": "How many are left, and after how many seconds all are again"}

CASE = {"anyOf": [{"$ref": "#/components/schemas/CaseSpec"}, {"$ref": "#/components/schemas/JobRequest"}]}
EXECUTE_BODY = {"requestBody": {"required": True, "content": {"application/json": {"schema": {
    "type": "object", "required": ["inputs"], "properties": {"inputs": {
        "type": "object", "required": ["case"], "properties": {"case": CASE}}}}}}}}
CASE_BODY = {"requestBody": {"required": True, "content": {"application/json": {
    "schema": CASE,
    "examples": {
        "shipped": {"summary": "a shipped case, changed",
                    "value": {"case": "elastica", "set": {"t_end": 5, "numerics.intervals": 50}, "label": "first"}},
    }}}}}


class Fault(BaseModel):
    """One refused value: where (in the body by `pointer`, or a `parameter`), what it was, and the rule."""

    pointer: str | None = Field(None, description="RFC 6901 pointer into the body")
    parameter: str | None = None
    value: Any = None
    rule: str


class ProblemDocument(BaseModel):
    """An error (RFC 9457)."""

    model_config = ConfigDict(title="Problem")
    type: str = Field(examples=["urn:hockle:problem:invalid_case"])
    title: str
    status: int
    detail: str = Field(description="what is wrong, and what to do")
    errors: list[Fault] | None = None


MODELS = (CaseSpec, JobRequest, EnsembleRequest, ProblemDocument)
"""What FastAPI does not find by itself."""


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The answers by which an operation refuses, for its `responses`."""
    return {status: {"description": HTTPStatus(status).phrase, "content": PROBLEM, **_headers(status)}
            for status in statuses}  # fmt: skip


def describe(app: FastAPI, keyed: bool) -> dict[str, Any]:
    """The document of `app`, made once. `keyed`: whether a key is required."""
    if app.openapi_schema is None:
        document = get_openapi(title=app.title, version=app.version, description=SUMMARY, routes=app.routes,
                               tags=app.openapi_tags)
        schemas = document.setdefault("components", {}).setdefault("schemas", {})
        _, definitions = models_json_schema([(model, "validation") for model in MODELS], ref_template=REF)
        schemas |= definitions["$defs"]
        schemas["Problem"] = schemas.pop("ProblemDocument")
        for name in NOT_OURS:
            schemas.pop(name, None)
        document["components"]["headers"] = {name: _header(text, required=keyed) for name, text in LIMITS.items()}
        for operations in document["paths"].values():
            for operation in operations.values():
                _complete(operation, keyed)
        app.openapi_schema = document
    return app.openapi_schema


def _complete(operation: dict[str, Any], keyed: bool) -> None:
    """Add what parameters mean, the problems that the gate and the scopes make, and those of faulty parameters."""
    for parameter in operation.get("parameters", []):
        parameter.setdefault("description", PARAMETERS.get(parameter["name"], ""))
    answers = operation["responses"]
    if "422" in answers:
        answers |= _named(problems(422))
    secured = "security" in operation
    answers |= _named(problems(*ANYWHERE, *(WITH_A_KEY if secured else ())))
    if any(parameter["name"] == "job_id" for parameter in operation.get("parameters", [])):
        answers |= _named(problems(410))
    if secured:
        if not keyed:
            operation["security"].append({})
        _tell_of_limits(answers)
    operation["responses"] = dict(sorted(answers.items()))


def _tell_of_limits(answers: dict[str, Any]) -> None:
    limits = {name: {"$ref": f"#/components/headers/{name}"} for name in LIMITS}
    for status in answers.keys() - BEFORE_THE_LIMIT:
        answers[status] = answers[status] | {"headers": answers[status].get("headers", {}) | limits}


def _headers(status: int) -> dict[str, Any]:
    headers = HEADERS.get(status)
    return {"headers": {name: _header(text) for name, text in headers.items()}} if headers else {}


def _header(text: str, required: bool = True) -> dict[str, Any]:
    return {"description": text, "required": required, "schema": {"type": "string"}}


def _named(answers: dict[int | str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    return {str(status): answer for status, answer in answers.items()}
