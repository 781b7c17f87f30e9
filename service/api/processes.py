"""/ogc: OGC API Processes (Part 1, 1.0) on the same jobs. One process, `simulate`: a case in, a dataset out."""

from __future__ import annotations

import asyncio
from datetime import datetime
from importlib.metadata import version
from typing import Annotated, Any, Literal, NoReturn

from fastapi import APIRouter, Depends, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from service.api.bodies import json_object
from service.api.description import EXECUTE_BODY, problems
from service.api.documents import JobDocument, document
from service.api.jobs import deleted
from service.api.numbers import WHOLE
from service.api.parts import InParts, Jobs, OwnJobs, Reader, Submitter
from service.api.problems import Problem
from service.api.submitting import understood
from service.cases import CaseError, FieldError
from service.jobs import ENDED, Job, Selection, Status

NETCDF = "application/x-netcdf"
PROCESS = "simulate"
REL = "http://www.opengis.net/def/rel/ogc/1.0"
EXCEPTION = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0"
CORE = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf"
CONFORMS_TO = [f"{CORE}/{name}" for name in ("core", "ogc-process-description", "json", "job-list", "dismiss")]
router = APIRouter(prefix="/ogc", tags=["OGC API Processes"])


class Link(BaseModel):
    """Where something else is found."""

    href: str
    rel: str
    type: str = "application/json"
    title: str = ""


class Landing(BaseModel):
    """What there is."""

    title: str
    description: str
    links: list[Link]


class Conformance(BaseModel):
    """The parts of the standard that are kept."""

    conformsTo: list[str]


class StatusInfo(BaseModel):
    """A job as the standard describes it; `progress` in percent."""

    processID: str
    type: Literal["process"] = "process"
    jobID: str
    status: Status
    message: str
    created: datetime
    started: datetime | None
    finished: datetime | None
    progress: int
    links: list[Link]


class JobList(BaseModel):
    """A page of jobs, newest first."""

    jobs: list[StatusInfo]
    links: list[Link]


class ProcessList(BaseModel):
    """The processes there are."""

    processes: list[dict[str, Any]]
    links: list[Link]


class Paging(BaseModel):
    """Which part of the list of jobs."""

    model_config = ConfigDict(extra="forbid")
    limit: Annotated[int, Field(ge=1, le=200), WHOLE] = 50
    status: Status | None = None
    after: str | None = Field(None, pattern="^[0-9a-z]{26}$")


@router.get("", response_model_exclude_none=True)
def landing_page(_: Reader) -> Landing:
    """Where everything is."""
    links = [
        Link(href="/ogc", rel="self"),
        Link(href="/v1/openapi.json", rel="service-desc", type="application/vnd.oai.openapi+json;version=3.1"),
        Link(href="/ogc/conformance", rel=f"{REL}/conformance"),
        Link(href="/ogc/processes", rel=f"{REL}/processes"),
        Link(href="/ogc/jobs", rel=f"{REL}/job-list"),
    ]
    return Landing(title="hockle", description="Simulations of elastic rods as OGC API Processes", links=links)


@router.get("/conformance")
def conformance(_: Reader) -> Conformance:
    """The parts of the standard that are kept."""
    return Conformance(conformsTo=CONFORMS_TO)


@router.get("/processes")
def processes(_: Reader) -> ProcessList:
    """The one process."""
    return ProcessList(processes=[_summary()], links=[Link(href="/ogc/processes", rel="self")])


@router.get("/processes/{process_id}", responses=problems(404))
def process(process_id: str, _: Reader) -> dict[str, Any]:
    """What the process takes and gives."""
    _check_process(process_id)
    case_input = {"title": "Case", "description": "As /v1/jobs takes it", "schema": {"type": "object"}}
    dataset = {"title": "Dataset", "schema": {"type": "string", "contentMediaType": NETCDF}}
    return _summary() | {"inputs": {"case": case_input}, "outputs": {"dataset": dataset}}


@router.post("/processes/{process_id}/execution", status_code=201, openapi_extra=EXECUTE_BODY,
             responses=problems(400, 404, 409, 413, 415, 422))
async def execute(request: Request, process_id: str, caller: Submitter, parts: InParts, response: Response,
                  body: Annotated[dict[str, Any], Depends(json_object)]) -> StatusInfo:
    """Accept a case to be run, as POST /v1/jobs does: a job of one's own that has run it is the answer instead of a new
    one, unless `reuse` is false."""
    _check_process(process_id)
    case = body.get("inputs", {}).get("case") if isinstance(body.get("inputs"), dict) else None
    if not isinstance(case, dict):
        raise CaseError([FieldError("/inputs/case", case, "must be an object: a case, or a shipped one with settings")])
    try:
        submission = await understood(request, case, parts, caller, "")
    except CaseError as error:
        inside = [FieldError(f"/inputs/case{fault.pointer}", fault.value, fault.rule) for fault in error.errors]
        raise CaseError(inside, error.more) from None
    with parts.submissions.put(submission) as future:
        job = await asyncio.wrap_future(future)
    response.headers["Location"] = f"/ogc/jobs/{job.id}"
    response.headers["Preference-Applied"] = "respond-async"
    return _status(job)


@router.get("/jobs", responses=problems(422))
def jobs_of_processes(jobs: Jobs, paging: Annotated[Paging, Query()]) -> JobList:
    """Jobs, newest first, a page at a time."""
    page = jobs.page(paging.limit, Selection(after=paging.after, status=paging.status))
    links = [Link(href="/ogc/jobs", rel="self")]
    if page.next is not None:
        status = f"&status={paging.status}" if paging.status else ""
        links.append(Link(href=f"/ogc/jobs?limit={paging.limit}&after={page.next}{status}", rel="next"))
    return JobList(jobs=[_status(job) for job in page.jobs], links=links)


@router.get("/jobs/{job_id}", responses=problems(404))
async def job_of_process(job_id: str, jobs: Jobs) -> StatusInfo:
    """One job."""
    return _status(jobs.get(job_id))


@router.get("/jobs/{job_id}/results", responses=problems(404))
async def results(job_id: str, jobs: Jobs) -> dict[str, Link]:
    """The outputs, by reference: the address of the dataset."""
    job = jobs.get(job_id)
    native = document(job)
    if job.status is not Status.SUCCESSFUL or native.dataset is None:
        _no_results(job)
    return {"dataset": Link(href=native.links["dataset"], rel="item", type=NETCDF)}


@router.delete("/jobs/{job_id}", responses=problems(404, 409))
def dismiss(job_id: str, parts: InParts, jobs: OwnJobs, caller: Submitter) -> StatusInfo:
    """Cancel a job, or delete one that has ended."""
    return _status(deleted(job_id, parts, jobs, caller))


def _summary() -> dict[str, Any]:
    return {
        "id": PROCESS, "title": "Simulate an elastic rod", "version": version("hockle"),
        "description": "Solves the Kirchhoff rod equations of a case in time",
        "jobControlOptions": ["async-execute", "dismiss"], "outputTransmission": ["reference"],
        "links": [{"href": f"/ogc/processes/{PROCESS}", "rel": "self", "type": "application/json"},
                  {"href": f"/ogc/processes/{PROCESS}/execution", "rel": f"{REL}/execute", "type": "application/json"}],
    }  # fmt: skip


def _check_process(process_id: str) -> None:
    if process_id != PROCESS:
        raise Problem(404, f"{EXCEPTION}/no-such-process", f"there is no process {process_id[:40]!r}, only {PROCESS}")


def _status(job: Job) -> StatusInfo:
    native: JobDocument = document(job)
    here = f"/ogc/jobs/{job.id}"
    links = [Link(href=here, rel="self"), Link(href=native.links["self"], rel="alternate")]
    if job.status is Status.SUCCESSFUL and native.dataset is not None:
        links.append(Link(href=f"{here}/results", rel=f"{REL}/results"))
    return StatusInfo(processID=PROCESS, jobID=job.id, status=job.status, message=job.message, created=native.created,
                      started=native.started, finished=native.finished, progress=int(100 * job.progress), links=links)


def _no_results(job: Job) -> NoReturn:
    if job.status in ENDED:
        raise Problem(404, "no_dataset", f"job {job.id} is {job.status} and has no results: {job.message}")
    raise Problem(404, f"{EXCEPTION}/result-not-ready", f"job {job.id} is {job.status}: its results come at its end")
