"""/v1/ensembles: many jobs at once, of cases that differ in some values; accepted, followed and cancelled as one."""

from __future__ import annotations

import asyncio
import hashlib
import json
from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Response
from pydantic import BaseModel, ConfigDict, Field

from service.access import Caller
from service.api.bodies import json_object
from service.api.description import problems
from service.api.designs import EnsembleRequest, ensemble_request
from service.api.documents import POLL_AFTER, address
from service.api.numbers import WHOLE
from service.api.parts import InParts, Parts, Reader, Submitter
from service.api.problems import Problem
from service.api.submitting import IdempotencyKey
from service.cases import CaseSpec, check_cost
from service.cases.beginning import Beginning, shared_beginnings
from service.cases.sampling import Values
from service.jobs import Job, NewJob, Status, new_id
from service.jobs.ensembles import Ensemble, Ensembles, Member, NewEnsemble, Standing, UnknownEnsemble

router = APIRouter(prefix="/v1/ensembles", tags=["ensembles"])

BODY = {"requestBody": {"required": True, "content": {"application/json": {
    "schema": {"$ref": "#/components/schemas/EnsembleRequest"},
    "examples": {
        "grid": {"summary": "all combinations",
                 "value": {"case": "elastica", "set": {"t_end": 5}, "parameters": {"loads.damping": [0.1, 0.2]}}},
        "sample": {"summary": "points of ranges",
                   "value": {"case": "elastica", "sample": {"method": "sobol", "size": 8, "seed": 1},
                             "parameters": {"damping": {"path": "loads.damping", "low": 0.1, "high": 1.0}}}},
    }}}}}  # fmt: skip


class EnsembleDocument(BaseModel):
    """An ensemble. `members` counts all, `counts` those of each status, `outcomes` how they ended; equal members are
    one of its `jobs`. `status`: `running` until all have ended, then the worst of theirs. `progress`: from 0 to 1."""

    id: str
    owner: str
    status: Status
    title: str
    label: str
    members: int
    jobs: int
    counts: dict[Status, int]
    outcomes: dict[str, int]
    progress: float
    design: dict[str, Any]
    created: datetime
    finished: datetime | None
    links: dict[str, str]


class EnsemblesDocument(BaseModel):
    """A page of ensembles, newest first; `next` is the address of the following page."""

    ensembles: list[EnsembleDocument]
    next: str | None


class MemberDocument(BaseModel):
    """A member: the values that it has, and how its job is doing."""

    number: int
    values: dict[str, Any]
    job: str
    status: Status
    phase: str
    progress: float
    t: float
    outcome: str
    message: str
    links: dict[str, str]


class MembersDocument(BaseModel):
    """A page of members in their order; `next` is the address of the following page."""

    members: list[MemberDocument]
    next: str | None


class Paging(BaseModel):
    """Which ensembles."""

    model_config = ConfigDict(extra="forbid")
    limit: Annotated[int, Field(ge=1, le=200), WHOLE] = 50
    after: str | None = Field(None, pattern="^[0-9a-z]{26}$", description="only ensembles older than this id")


class MemberPaging(BaseModel):
    """Which members."""

    model_config = ConfigDict(extra="forbid")
    limit: Annotated[int, Field(ge=1, le=1000), WHOLE] = 200
    after: Annotated[int, Field(ge=-1, le=2**31 - 1, description="only members with a higher number"), WHOLE] = -1
    status: Status | None = None


async def _visible(parts: InParts, caller: Reader) -> Ensembles:
    return Ensembles(parts.registry.database, caller.sees)


VisibleEnsembles = Annotated[Ensembles, Depends(_visible)]


def ensemble_of(ensembles: Ensembles, ensemble_id: str) -> Ensemble:
    """One of them. Raises Problem 404."""
    try:
        return ensembles.get(ensemble_id)
    except UnknownEnsemble:
        raise Problem(404, "unknown_ensemble", f"there is no ensemble {ensemble_id[:40]!r}") from None


@router.post("", status_code=202, response_model=EnsembleDocument, openapi_extra=BODY,
             responses=problems(400, 409, 413, 415, 422))
async def submit_ensemble(parts: InParts, caller: Submitter, body: Annotated[dict[str, Any], Depends(json_object)],
                          idempotency_key: IdempotencyKey = None) -> Response:
    """Accept many cases at once: a grid, a list or a sample of values in one case. All of them are accepted, or none.

    Each member is an ordinary job; members with the same case are one job, and one that has run it before is as good,
    unless `reuse` is false.
    """
    async with parts.one_ensemble:
        return await asyncio.to_thread(_accepted, body, parts, caller, idempotency_key or "")


def _accepted(body: dict[str, Any], parts: Parts, caller: Caller, key: str) -> Response:
    new = requested(ensemble_request(body), body, parts, caller, key)
    ensembles = Ensembles(parts.registry.database, caller.owner)
    accepted = ensembles.submit(new, parts.submissions.terms)
    parts.submissions.announce()
    return answer(ensembles.get(accepted), ensembles.standing(accepted), 202)


def requested(request: EnsembleRequest, body: dict[str, Any], parts: Parts, caller: Caller, key: str) -> NewEnsemble:
    """What is asked for, understood. Raises CaseError for a member's case or cost, or for the limits."""
    limits, values = request.limits.within(parts.settings.limits), request.values()
    ids = sorted(new_id() for _ in values)  # the first member goes first
    jobs = []
    for job_id, (spec, begins) in zip(ids, _with_beginnings(request, values), strict=True):
        check_cost(spec, parts.settings.longest_run)
        title = spec.title or spec.name
        leader, frame = (ids[begins.leader], begins.frame) if begins is not None else (None, 0)
        jobs.append(NewJob(spec.document(), title, caller.owner, request.label, request.priority, limits, job_id,
                           leader, frame, waits=leader is not None))  # fmt: skip
    digest = hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()
    return NewEnsemble(request.design, values, jobs, caller.actor, request.title or jobs[0].title, request.label, key,
                       digest, request.reuse)  # fmt: skip


def _with_beginnings(request: EnsembleRequest, values: list[Values]) -> Iterator[tuple[CaseSpec, Beginning | None]]:
    """The members' cases, and with which of the others each begins; one after the other, where that is not to be
    known."""
    if not request.differs_late:
        yield from ((spec, None) for spec in request.specs(values))
        return
    specs = list(request.specs(values))
    yield from zip(specs, shared_beginnings(specs), strict=True)


@router.get("", responses=problems(422))
def list_ensembles(paging: Annotated[Paging, Query()], ensembles: VisibleEnsembles) -> EnsemblesDocument:
    """Ensembles, newest first, a page at a time."""
    page = ensembles.page(paging.limit + 1, paging.after)
    documents = [document(ensemble, ensembles.standing(ensemble.id)) for ensemble in page[: paging.limit]]
    more = len(page) > paging.limit
    following = f"/v1/ensembles?limit={paging.limit}&after={documents[-1].id}" if more else None
    return EnsemblesDocument(ensembles=documents, next=following)


@router.get("/{ensemble_id}", response_model=EnsembleDocument, responses=problems(404))
def ensemble_status(ensemble_id: str, ensembles: VisibleEnsembles) -> Response:
    """How an ensemble is doing as a whole."""
    ensemble = ensemble_of(ensembles, ensemble_id)
    return answer(ensemble, ensembles.standing(ensemble.id))


@router.post("/{ensemble_id}/cancel", responses=problems(404))
def cancel_ensemble(ensemble_id: str, parts: InParts, caller: Submitter) -> EnsembleDocument:
    """Cancel all members that have not ended."""
    ensembles = Ensembles(parts.registry.database, caller.sees)
    ensemble = ensemble_of(ensembles, ensemble_id)
    ensembles.cancel(ensemble.id, caller.actor)
    return document(ensemble, ensembles.standing(ensemble.id))


@router.get("/{ensemble_id}/members", responses=problems(404, 422))
def ensemble_members(ensemble_id: str, paging: Annotated[MemberPaging, Query()],
                     ensembles: VisibleEnsembles) -> MembersDocument:
    """The members in their order, with their values and how their jobs are doing, a page at a time."""
    ensemble = ensemble_of(ensembles, ensemble_id)
    page = ensembles.members(ensemble.id, paging.limit + 1, paging.after, paging.status)
    documents = [member_document(ensemble, member) for member in page[: paging.limit]]
    following = None
    if len(page) > paging.limit:
        status = f"&status={paging.status}" if paging.status else ""
        following = f"{here(ensemble)}/members?limit={paging.limit}&after={documents[-1].number}{status}"
    return MembersDocument(members=documents, next=following)


def here(ensemble: Ensemble) -> str:
    """Where it is found."""
    return f"/v1/ensembles/{ensemble.id}"


def member_document(ensemble: Ensemble, member: Member) -> MemberDocument:
    """A member as its readers see it."""
    job: Job = member.job
    job_address = address(job.id)
    return MemberDocument(
        number=member.number, values=dict(zip(ensemble.names, member.values, strict=True)), job=job.id,
        status=job.status, phase=job.phase, progress=job.progress, t=job.t, outcome=job.outcome, message=job.message,
        links={"job": job_address, "data": f"{job_address}/data"},
    )  # fmt: skip


def document(ensemble: Ensemble, standing: Standing) -> EnsembleDocument:
    """An ensemble as its readers see it."""
    own_address = here(ensemble)
    links = {name: f"{own_address}/{name}" for name in ("members", "events", "scalars", "data")}
    if ensemble.design["method"] == "saltelli":
        links["sensitivity"] = f"{own_address}/sensitivity"
    return EnsembleDocument(
        id=ensemble.id, owner=ensemble.owner, status=standing.status, title=ensemble.title, label=ensemble.label,
        members=standing.members, jobs=standing.jobs,
        counts={status: standing.statuses[status] for status in Status}, outcomes=dict(standing.outcomes),
        progress=standing.progress, design=ensemble.design, created=datetime.fromtimestamp(ensemble.created, UTC),
        finished=None if standing.finished is None else datetime.fromtimestamp(standing.finished, UTC),
        links={"self": own_address} | links,
    )  # fmt: skip


def answer(ensemble: Ensemble, standing: Standing, status: int = 200) -> Response:
    """An ensemble as an answer: where it is found, and when to ask again."""
    headers = {"Location": here(ensemble), "Cache-Control": "no-cache"}
    if not standing.ended:
        headers["Retry-After"] = POLL_AFTER
    return Response(document(ensemble, standing).model_dump_json(), status, headers, "application/json")
