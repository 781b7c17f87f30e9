"""/v1/queue, /v1/hosts: what workers there are, and pauses; /v1/jobs/{id}/requeue: a failed job's case once more."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response
from pydantic import BaseModel

from service.api.description import problems
from service.api.documents import JobDocument, answer
from service.api.parts import InParts, Operator, OwnJobs, Parts, Submitter
from service.api.problems import Problem
from service.jobs import NewJob, Status
from service.jobs.audit import Actor, note
from service.jobs.measures import counted
from service.jobs.pauses import Pause, pause, paused, resume
from service.jobs.processes import hosts
from service.jobs.sharing import ALL_HOSTS
from service.jobs.submission import Submission

router = APIRouter(prefix="/v1", tags=["service"])

Host = Annotated[str, Path(min_length=1, max_length=64, description="A host, as /v1/queue names it")]
Drain = Annotated[bool, Query(description="also hand back what runs, with a checkpoint")]


class PauseDocument(BaseModel):
    """Since when no job is taken, and by whom it was said; `drains`: what ran was handed back too."""

    drains: bool
    since: datetime
    owner: str


class HostDocument(BaseModel):
    """A host: how many jobs it can run at once, and its pause."""

    name: str
    workers: int
    paused: PauseDocument | None


class Workforce(BaseModel):
    """The jobs that wait and run, the pause of the whole queue, and the hosts that have workers or are paused."""

    waiting: int
    running: int
    paused: PauseDocument | None
    hosts: list[HostDocument]


@router.get("/queue")
def workforce(parts: InParts, _: Operator) -> Workforce:
    """How many jobs wait and run, which hosts have workers, and which are paused."""
    return _workforce(parts)


@router.put("/queue/pause")
def pause_queue(parts: InParts, caller: Operator, drain: Drain = False) -> Workforce:
    """Have no worker take a job from now on."""
    pause(parts.registry.database, ALL_HOSTS, drain, caller.actor)
    return _workforce(parts)


@router.delete("/queue/pause")
def resume_queue(parts: InParts, caller: Operator) -> Workforce:
    """Have the workers take jobs again, but for those of hosts that are paused themselves."""
    return _resumed(parts, ALL_HOSTS, caller.actor)


@router.put("/hosts/{host}/pause", responses=problems(404))
def pause_host(host: Host, parts: InParts, caller: Operator, drain: Drain = False) -> Workforce:
    """Have the workers of a host take no job from now on."""
    _check_known(parts, host)
    pause(parts.registry.database, host, drain, caller.actor)
    return _workforce(parts)


@router.delete("/hosts/{host}/pause", responses=problems(404))
def resume_host(host: Host, parts: InParts, caller: Operator) -> Workforce:
    """Have the workers of a host take jobs again."""
    _check_known(parts, host)
    return _resumed(parts, host, caller.actor)


@router.post("/jobs/{job_id}/requeue", status_code=202, response_model=JobDocument, tags=["jobs"],
             responses=problems(404, 409))
def requeue(job_id: str, parts: InParts, jobs: OwnJobs, caller: Submitter) -> Response:
    """Submit the case of a failed job again, for its owner and with its label, priority and limits; the answer is the
    new job. The failed one stays as it is."""
    failed = jobs.get(job_id)
    if failed.status is not Status.FAILED:
        raise Problem(409, "not_failed", f"job {job_id} is {failed.status}: only what failed is queued again")
    new = NewJob(jobs.case(job_id), failed.title, failed.owner, failed.label, failed.priority, failed.limits)
    with parts.submissions.put(Submission(new, caller.actor)) as future:
        job = future.result()
    with parts.registry.database.writing() as transaction:
        note(transaction, caller.actor, "job_requeued", job_id)
    return answer(job, 202)


def _resumed(parts: Parts, host: str, actor: Actor) -> Workforce:
    resume(parts.registry.database, host, actor)
    return _workforce(parts)


def _workforce(parts: Parts) -> Workforce:
    database = parts.registry.database
    waiting, running = counted(database)
    pauses, workers = {pause.host: pause for pause in paused(database)}, hosts(database)
    named = sorted((workers.keys() | pauses.keys()) - {ALL_HOSTS})
    return Workforce(
        waiting=waiting, running=running, paused=_document(pauses.get(ALL_HOSTS)),
        hosts=[HostDocument(name=name, workers=workers.get(name, 0), paused=_document(pauses.get(name)))
               for name in named],
    )  # fmt: skip


def _document(pause: Pause | None) -> PauseDocument | None:
    if pause is None:
        return None
    return PauseDocument(drains=pause.drains, since=datetime.fromtimestamp(pause.since, UTC), owner=pause.owner)


def _check_known(parts: Parts, host: str) -> None:
    known = [document.name for document in _workforce(parts).hosts]
    if host not in known:
        raise Problem(404, "unknown_host", f"no worker is on {host[:64]!r}; there are {', '.join(known) or 'none'}")
