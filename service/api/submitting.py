"""POST /v1/jobs: a case is handed in."""

from __future__ import annotations

import asyncio
import hashlib
import json
from typing import Annotated, Any

from fastapi import APIRouter, Header, Request, Response

from service.access import Caller
from service.api.again import Again
from service.api.bodies import LARGEST_BODY, at_leisure, json_object
from service.api.description import CASE_BODY, problems
from service.api.documents import JobDocument, answer
from service.api.parts import InParts, Parts, Submitter
from service.api.preferences import wait_preferred
from service.api.problems import Problem
from service.api.requests import parse_request
from service.cases import CaseError, FieldError, check_cost
from service.jobs import ENDED, Job, NewJob
from service.jobs.submission import Submission
from service.webhooks import fault_of

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

IdempotencyKey = Annotated[
    str | None, Header(alias="Idempotency-Key", min_length=1, max_length=255, pattern="^[ -~]+$")
]
ANSWERS: dict[int | str, dict[str, Any]] = {
    202: {"model": JobDocument, "description": "Accepted: the job is on disk, and will be run."},
    200: {"model": JobDocument, "description": "Ended: it was run before, or within the time of Prefer: wait."},
}


@router.post("", status_code=202, response_model=JobDocument, openapi_extra=CASE_BODY,
             responses={**ANSWERS, **problems(400, 404, 409, 413, 415, 422)})
async def submit(
    request: Request, parts: InParts, caller: Submitter, idempotency_key: IdempotencyKey = None,
    prefer: Annotated[str | None, Header(alias="Prefer", description="`wait=SECONDS`, up to 60")] = None,
) -> Response:
    """Accept a case to be run; the job is on disk when the answer comes.

    With an Idempotency-Key a submission may be sent again after a lost answer: the same key and body give the same
    job for a day. A job of one's own that has run the same case is the answer instead of a new one, unless `reuse` is
    false.
    """
    body = await json_object(request)
    submission = await understood(request, body, parts, caller, idempotency_key or "")
    with parts.submissions.put(submission) as future:
        job = await asyncio.wrap_future(future)
    seconds = wait_preferred(prefer)
    job = await until_ended(job, seconds, parts)
    headers = {} if seconds is None else {"Preference-Applied": f"wait={seconds}"}
    return answer(job, 200 if job.status in ENDED else 202, headers)


async def understood(request: Request, body: dict[str, Any], parts: Parts, caller: Caller, key: str) -> Submission:
    """`requested`, beside the event loop where the case may be large: that of the request, or of a job it names."""
    size = LARGEST_BODY if "job" in body else request.state.body_size
    return await at_leisure(size, requested, body, parts, caller, key)


def requested(body: dict[str, Any], parts: Parts, caller: Caller, key: str) -> Submission:
    """What a body asks of the registry. Raises CaseError for its case, cost or limits, Problem for its
    webhook."""
    other = Again.of(body, parts.registry.of(caller.sees)) if "job" in body else None
    parsed = parse_request(other.body if other else body)
    spec, request = parsed.spec, parsed.request
    if other is not None:
        other.check(spec)
    check_cost(spec, parts.settings.longest_run)
    if request.webhook is not None and not caller.key:
        raise Problem(422, "webhook_needs_key", "a webhook is signed with the API key that asks for it: send one")
    if request.webhook is not None and (rule := fault_of(request.webhook)):
        raise CaseError([FieldError("/webhook", request.webhook, rule)])
    limits = request.limits.within(parts.settings.limits)
    new = NewJob(spec.document(), spec.title or spec.name, caller.owner, request.label, request.priority, limits,
                 **(other.beginning(spec) if other else {}))
    digest = hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest() if key else ""
    return Submission(new, caller.actor, key, digest, request.reuse, request.webhook or "")


async def until_ended(job: Job, seconds: int | None, parts: Parts) -> Job:
    """The job when it has ended, or as it is after so many seconds."""
    loop = asyncio.get_running_loop()
    end = loop.time() + (seconds or 0)
    while job.status not in ENDED and (left := end - loop.time()) > 0:
        if await parts.feed.changed(job, left):
            job = parts.registry.get(job.id)
    return job
