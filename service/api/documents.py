"""What the interface says of a job."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime

from fastapi import Response
from pydantic import BaseModel

from service.jobs import ENDED, Job, Status

POLL_AFTER = "1"


class DatasetDocument(BaseModel):
    """A dataset that can be fetched, but where a `fault` was found: it is missing or damaged."""

    href: str
    sha256: str
    bytes: int
    fault: str


class LimitsDocument(BaseModel):
    """What a job may use: seconds of running, bytes of memory and of disk."""

    wall: float
    memory: int
    disk: int


class WebhookDocument(BaseModel):
    """Whom the end of a job is told: how often that was tried, what came of the last try, and when the next one is."""

    url: str
    deliveries: int
    last: str
    next_attempt: datetime | None


class JobDocument(BaseModel):
    """A job. `progress` goes from 0 to 1, `t` is simulated seconds, `remaining` the seconds that are left if it goes on
    as so far; `message` says what to do next, `attributes` what the run as a whole says, as its dataset does: its
    errors, whether the tolerance is met, crossings and the like."""

    id: str
    owner: str
    status: Status
    title: str
    label: str
    priority: int
    phase: str
    progress: float
    remaining: float | None
    t: float
    outcome: str
    message: str
    cancel_requested: bool
    pinned: bool
    attempts: int
    created: datetime
    started: datetime | None
    finished: datetime | None
    case_sha256: str
    begins_with: str | None
    attributes: dict[str, float | int | str]
    limits: LimitsDocument
    dataset: DatasetDocument | None
    webhook: WebhookDocument | None
    links: dict[str, str]


class JobsDocument(BaseModel):
    """A page of jobs, newest first; `next` is the address of the following page."""

    jobs: list[JobDocument]
    next: str | None


def document(job: Job) -> JobDocument:
    """A job as its readers see it."""
    here = address(job.id)
    links = {"self": here, "events": f"{here}/events", "case": f"{here}/case", "data": f"{here}/data"}
    dataset = None
    if job.dataset is not None:
        links |= {name: f"{here}/{name}" for name in ("dataset", "zarr", "opendap")}
        dataset = DatasetDocument(href=links["dataset"], sha256=job.dataset.sha256, bytes=job.dataset.bytes,
                                  fault=job.dataset.fault)
    return JobDocument(
        id=job.id, owner=job.owner, status=job.status, title=job.title, label=job.label, priority=job.priority,
        phase=job.phase, progress=job.progress, remaining=job.remaining, t=job.t, outcome=job.outcome,
        message=job.message, cancel_requested=job.cancel_requested, pinned=job.pinned, attempts=job.attempts,
        created=_instant(job.created), started=job.started and _instant(job.started),
        finished=job.finished and _instant(job.finished), case_sha256=job.case_sha256, begins_with=job.begins_with,
        attributes=job.attributes, limits=LimitsDocument(**vars(job.limits)), dataset=dataset,
        webhook=_webhook(job), links=links,
    )


def _webhook(job: Job) -> WebhookDocument | None:
    hook = job.webhook
    if hook is None:
        return None
    due = hook.due if hook.due is None or job.finished is None else max(hook.due, job.finished)
    upcoming = _instant(due) if due is not None and job.status in ENDED else None
    return WebhookDocument(url=hook.url, deliveries=hook.tries, last=hook.answer, next_attempt=upcoming)


def answer(job: Job, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    """A job as an answer: with its ETag, where it is found, and when to ask again."""
    fields = {"ETag": f'"{job.version}"', "Cache-Control": "no-cache", "Location": address(job.id), **(headers or {})}
    if job.status not in ENDED:
        fields["Retry-After"] = POLL_AFTER
    return Response(document(job).model_dump_json(), status, fields, "application/json")


def address(job_id: str) -> str:
    """Where a job is found."""
    return f"/v1/jobs/{job_id}"


def _instant(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, UTC)
