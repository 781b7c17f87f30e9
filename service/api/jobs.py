"""/v1/jobs: list, follow, cancel, delete, pin."""

from __future__ import annotations

import re
from typing import Annotated, Any
from urllib.parse import urlencode

from fastapi import APIRouter, Query, Request, Response
from pydantic import AwareDatetime, BaseModel, BeforeValidator, ConfigDict, Field

from service.access import Caller, Scope
from service.api.description import NOT_MODIFIED, problems
from service.api.documents import JobDocument, JobsDocument, answer, document
from service.api.numbers import WHOLE
from service.api.parts import InParts, Jobs, OwnJobs, Parts, Reader, Submitter, matches
from service.api.problems import Problem
from service.jobs import Job, Registry, Selection, Status
from service.meaning import NO_CONTROL
from service.store.removal import remove_files

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])


INSTANT = re.compile(r"\d{4}-\d\d-\d\d[Tt ]\d\d:\d\d:\d\d(\.\d+)?([Zz]|[+-]\d\d:\d\d)")


def _rfc_3339(text: object) -> object:
    if not (isinstance(text, str) and INSTANT.fullmatch(text)):  # bare numbers would be taken for Unix seconds
        raise ValueError("must be a time with its offset, as 2026-01-31T12:00:00Z (RFC 3339)")
    return text


Instant = Annotated[AwareDatetime, BeforeValidator(_rfc_3339)]


class Listing(BaseModel):
    """Which jobs a list holds."""

    model_config = ConfigDict(extra="forbid")
    limit: Annotated[int, Field(ge=1, le=200), WHOLE] = 50
    after: str | None = Field(None, pattern="^[0-9a-z]{26}$", description="only jobs older than this id")
    status: Status | None = None
    label: str | None = Field(None, max_length=100, pattern=NO_CONTROL)
    owner: str | None = Field(None, max_length=64, pattern=NO_CONTROL,
                              description="another than oneself needs the scope operate")
    since: Instant | None = Field(None, description="submitted at this time or later")
    until: Instant | None = Field(None, description="submitted before this time")
    ensemble: str | None = Field(None, pattern="^[0-9a-z]{26}$", description="only members of the one with this id")

    def selection(self) -> Selection:
        """The same for the registry."""
        since, until = (None if time is None else time.timestamp() for time in (self.since, self.until))
        return Selection(self.after, self.status, self.label, self.owner, since, until, self.ensemble)


@router.get("", response_model=JobsDocument, responses=problems(422))
def list_jobs(listing: Annotated[Listing, Query()], jobs: Jobs, caller: Reader) -> Response:
    """Jobs, newest first, a page at a time; `next` is the address of the next page."""
    if listing.owner not in (None, caller.owner) and Scope.OPERATE not in caller.scopes:
        raise Problem(403, "scope_missing", f"jobs of another owner than {caller.owner} need the scope operate")
    page = jobs.page(listing.limit, listing.selection())
    following = None
    if page.next is not None:
        query = listing.model_dump(mode="json", exclude_none=True) | {"after": page.next}
        following = f"/v1/jobs?{urlencode(query)}"
    listed = JobsDocument(jobs=[document(job) for job in page.jobs], next=following)
    return Response(listed.model_dump_json(), media_type="application/json")


@router.get("/{job_id}", response_model=JobDocument, responses={**NOT_MODIFIED, **problems(404)})
async def status(job_id: str, request: Request, jobs: Jobs) -> Response:
    """One job. Its ETag is its version: with If-None-Match the answer is 304 while nothing has changed."""
    job = jobs.get(job_id)  # a point read of some 0.2 ms: cheaper here than in another thread
    if matches(request, f'"{job.version}"'):
        return Response(status_code=304, headers={"ETag": f'"{job.version}"', "Cache-Control": "no-cache"})
    return answer(job)


@router.get("/{job_id}/case", responses=problems(404))
def case(job_id: str, jobs: Jobs) -> dict[str, Any]:
    """The case of a job with every default filled in, as it is run."""
    return jobs.case(job_id)


class QueueDocument(BaseModel):
    """Where a job waits: how many of its owner's jobs go first. Owners take turns, however many jobs each has."""

    before: int


@router.get("/{job_id}/queue", responses=problems(404))
def queue(job_id: str, jobs: Jobs) -> QueueDocument:
    """How many jobs of its owner go first; 0 also where it does not wait any more."""
    return QueueDocument(before=jobs.before(jobs.get(job_id)))


@router.post("/{job_id}/cancel", responses=problems(404))
def cancel(job_id: str, jobs: OwnJobs, caller: Submitter) -> JobDocument:
    """Cancel a job: at once if it waits, within a second if it runs, and `dismissed` is how it then ends, however near
    its end it was; an ended one stays as it is."""
    return document(jobs.cancel(job_id, caller.actor))


@router.delete("/{job_id}", responses=problems(404, 409))
def delete(job_id: str, parts: InParts, jobs: OwnJobs, caller: Submitter) -> JobDocument:
    """Delete a job that has ended, with its dataset: afterwards the answer is 410, with who and when. One that has not
    is cancelled."""
    return document(deleted(job_id, parts, jobs, caller))


def deleted(job_id: str, parts: Parts, jobs: Registry, caller: Caller) -> Job:
    """The job as it was before it was deleted, or is now that it is cancelled."""
    job = jobs.get(job_id)
    if not jobs.delete(job_id, caller.actor):
        return jobs.cancel(job_id, caller.actor)
    remove_files(parts.registry.database, parts.datasets)
    return job


@router.put("/{job_id}/pin", responses=problems(404))
def pin(job_id: str, jobs: OwnJobs, caller: Submitter) -> JobDocument:
    """Keep a job: neither retention nor DELETE takes it."""
    return document(jobs.pin(job_id, True, caller.actor))


@router.delete("/{job_id}/pin", responses=problems(404))
def unpin(job_id: str, jobs: OwnJobs, caller: Submitter) -> JobDocument:
    """Let a job be deleted."""
    return document(jobs.pin(job_id, False, caller.actor))
