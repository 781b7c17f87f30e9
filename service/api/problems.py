"""Every error of the interface as application/problem+json (RFC 9457)."""

from __future__ import annotations

import json
import logging
from collections.abc import Mapping
from datetime import UTC, datetime
from http import HTTPStatus
from typing import Any, cast

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from sqlalchemy.exc import DBAPIError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeout
from starlette.exceptions import HTTPException
from starlette.routing import Match

from service.cases import MOST_ERRORS, CaseError, FieldError
from service.cases.errors import field_error
from service.cases.suggestions import with_suggestion
from service.jobs import DeletedJob, Pinned, UnknownJob
from service.jobs.sqlite import FilesReplaced
from service.jobs.submission import KeyReused, QuotaReached
from service.jobs.submissions import InFlight

LONGEST_VALUE = 200
AWAY = (OperationalError, InterfaceError, PoolTimeout)
"""What a database says that is away, locked or full."""
SOON = "10"  # s: when a job will end is not known
METHODS = ("DELETE", "GET", "HEAD", "PATCH", "POST", "PUT")
log = logging.getLogger(__name__)


class Problem(Exception):
    """An answer that is not the one that was hoped for."""

    def __init__(self, status: int, name: str, detail: str, headers: Mapping[str, str] | None = None,
                 **extensions: Any) -> None:
        super().__init__(detail)
        self.status, self.name, self.detail = status, name, detail
        self.headers, self.extensions = headers, extensions

    def response(self) -> JSONResponse:
        """The problem as its client reads it."""
        kind = self.name if "://" in self.name else f"urn:hockle:problem:{self.name}"
        body = {"type": kind, "title": HTTPStatus(self.status).phrase,
                "status": self.status, "detail": self.detail}
        return JSONResponse(body | self.extensions, self.status, self.headers, "application/problem+json")


def install(app: FastAPI) -> None:
    """Have `app` answer every exception with a problem."""
    app.exception_handler(Problem)(_problem)
    app.exception_handler(HTTPException)(_http)
    app.exception_handler(RequestValidationError)(_parameters)
    app.exception_handler(CaseError)(_case)
    app.exception_handler(UnknownJob)(_unknown_job)
    app.exception_handler(DeletedJob)(_deleted_job)
    app.exception_handler(Pinned)(_pinned)
    app.exception_handler(KeyReused)(_key_reused)
    app.exception_handler(InFlight)(_in_flight)
    app.exception_handler(QuotaReached)(_quota)
    app.exception_handler(DBAPIError)(_database)
    app.exception_handler(PoolTimeout)(_database)
    app.exception_handler(Exception)(_bug)


def shown(value: Any) -> Any:
    """A refused value as a problem quotes it: itself if it is short JSON, else the start of its text."""
    try:
        text = json.dumps(value, allow_nan=False)
        text.encode()
    except (TypeError, ValueError):
        return ascii(value)[:LONGEST_VALUE]
    return value if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + "..."


async def _problem(_: Request, error: Problem) -> JSONResponse:
    return error.response()


async def _http(request: Request, error: HTTPException) -> JSONResponse:
    name = HTTPStatus(error.status_code).name.lower()
    detail = f"{error.detail}: {request.method} {request.url.path}"
    headers = {"Allow": _allowed(request)} if error.status_code == 405 else error.headers
    return Problem(error.status_code, name, detail, headers).response()


def _allowed(request: Request) -> str:
    """The methods of every route at this address; each route by itself knows only its own."""
    def is_there(method: str) -> bool:
        scope = {**request.scope, "method": method}
        return any(route.matches(scope)[0] is Match.FULL for route in request.app.routes)

    return ", ".join(filter(is_there, METHODS))


async def _parameters(request: Request, error: RequestValidationError) -> JSONResponse:
    faults = [field_error(fault | {"loc": fault["loc"][1:]}) for fault in error.errors()[:MOST_ERRORS]]
    faults = [with_suggestion(fault, fault.pointer[1:], _parameters_of(request)) if fault.unknown else fault
              for fault in faults]  # fmt: skip
    errors = [{"parameter": fault.pointer[1:].replace("/", "."), "value": shown(fault.value), "rule": fault.rule}
              for fault in faults]
    return Problem(422, "invalid_parameters", _summary("parameter", errors), errors=errors).response()


def _parameters_of(request: Request) -> list[str]:
    """The names of the parameters that the query of this route may have."""
    models = [parameter.field_info.annotation for parameter in request.scope["route"].dependant.query_params]
    return [name for model in models for name in getattr(model, "model_fields", ())]


async def _case(_: Request, error: CaseError) -> JSONResponse:
    errors = [{"pointer": e.pointer, "value": shown(e.value), "rule": e.rule} for e in error.errors]
    return Problem(422, "invalid_case", _summary("pointer", errors, error.more), errors=errors).response()


async def _unknown_job(_: Request, error: Exception) -> JSONResponse:
    return Problem(404, "unknown_job", f"there is no job {str(error)[:40]!r}").response()


async def _deleted_job(_: Request, error: Exception) -> JSONResponse:
    job = cast(DeletedJob, error).job
    when = datetime.fromtimestamp(job.deleted or 0.0, UTC).isoformat(timespec="seconds")
    detail = f"job {job.id} was deleted by {job.deleted_by} at {when}"
    return Problem(410, "job_deleted", detail, deleted=when, deleted_by=job.deleted_by).response()


async def _pinned(_: Request, error: Exception) -> JSONResponse:
    detail = f"job {error} is pinned: unpin it (hockle unpin ID, DELETE /v1/jobs/{error}/pin) before it is deleted"
    return Problem(409, "pinned", detail).response()


async def _key_reused(_: Request, error: Exception) -> JSONResponse:
    detail = f"the Idempotency-Key {str(error)[:80]!r} came with another body before: use a new one"
    return Problem(422, "idempotency_key_reused", detail).response()


async def _in_flight(_: Request, error: Exception) -> JSONResponse:
    detail = f"the submission with the Idempotency-Key {str(error)[:80]!r} is still being written: ask again"
    return Problem(409, "in_flight", detail, {"Retry-After": "1"}).response()


async def _quota(_: Request, error: Exception) -> JSONResponse:
    return Problem(429, "quota_reached", str(error), {"Retry-After": SOON}).response()


async def _database(request: Request, error: Exception) -> JSONResponse:
    problem = unreachable(error)
    if problem is None:
        return await _bug(request, error)
    log.error("%s %s: the database does not answer: %s", request.method, request.url.path, error)
    return problem.response()


def unreachable(error: Exception) -> Problem | None:
    """What to say where the database is away, locked or full; None where it is something else."""
    if not isinstance(error, AWAY):
        return None
    detail = "the database does not answer, or has no room: nothing was changed; try again later"
    if isinstance(error, FilesReplaced):
        detail = "the registry's files were removed or replaced under the running service: an operator must look at it"
    return Problem(503, "database_unreachable", detail, {"Retry-After": SOON})


async def _bug(request: Request, error: Exception) -> JSONResponse:
    log.error("%s %s failed", request.method, request.url.path, exc_info=error)
    return Problem(500, "internal_error", "hockle itself failed; its log says where").response()


def _summary(where: str, errors: list[dict[str, Any]], omitted: int = 0) -> str:
    faults = [FieldError(e[where] or "the whole", e["value"], e["rule"]) for e in errors[:3]]
    first, more = "; ".join(map(str, faults)), len(errors) - 3 + omitted
    return first if more <= 0 else f"{first}; and {more} more"
