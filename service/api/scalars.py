"""/v1/scalars: the last values of many jobs at once."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import BaseModel, ConfigDict, Field

from service.api.datasets import there
from service.api.description import problems
from service.api.parts import InParts, Jobs, Parts
from service.api.problems import Problem
from service.jobs import Job, Status
from service.results import UnknownVariable
from service.results.scalars import Value, last_values, scalar_variables

MOST_JOBS = 200
router = APIRouter(prefix="/v1/scalars", tags=["results"])


class Chosen(BaseModel):
    """Which numbers of which jobs."""

    model_config = ConfigDict(extra="forbid")
    jobs: str = Field(min_length=1, max_length=27 * MOST_JOBS, examples=["01m7zns6je0661bz8g4vdfp4fq"],
                      description=f"Ids of jobs, at most {MOST_JOBS}, with commas between them")
    variables: str = Field(min_length=1, max_length=1000, examples=["Tw,Wr,Lk"])


class ScalarsOfJob(BaseModel):
    """The last values of a job's variables; null where it has no dataset, or the dataset no such value."""

    id: str
    label: str
    status: Status
    outcome: str
    t: float
    values: dict[str, Value]


class ScalarsDocument(BaseModel):
    """A record of each job, in the order in which they were named."""

    jobs: list[ScalarsOfJob]


@router.get("", responses=problems(404, 422, 503))
def scalars(chosen: Annotated[Chosen, Query()], parts: InParts, jobs: Jobs) -> ScalarsDocument:
    """Variables that have no place along the rod, at the end of many jobs."""
    ids = [one.strip() for one in chosen.jobs.split(",")]
    if len(ids) > MOST_JOBS:
        raise Problem(422, "too_many_jobs", f"jobs must be at most {MOST_JOBS}, got {len(ids)}")
    try:
        names = scalar_variables([name.strip() for name in chosen.variables.split(",")])
    except UnknownVariable as error:
        raise Problem(422, "unknown_variable", str(error)) from None
    return ScalarsDocument(jobs=[_of(jobs.get(job_id), names, parts) for job_id in ids])


def _of(job: Job, names: list[str], parts: Parts) -> ScalarsOfJob:
    values: dict[str, Value] = dict.fromkeys(names)
    if job.dataset is not None:
        with there(job):
            path = parts.datasets.file(job.dataset.file, job.dataset.bytes, job.dataset.sha256)
        values = last_values(path, names)
    return ScalarsOfJob(id=job.id, label=job.label, status=job.status, outcome=job.outcome, t=job.t, values=values)
