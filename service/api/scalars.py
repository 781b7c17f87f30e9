"""/v1/scalars: the last values of many jobs at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np
from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, Field

from service.api.datasets import available, dataset_of
from service.api.description import problems
from service.api.formats import CONTENT, Accept, Variables, format_of, readable, response_of
from service.api.parts import InParts, Jobs, Parts
from service.api.problems import Problem
from service.jobs import Job, Registry, Status
from service.results.part import Column, Part
from service.results.scalars import Value, last_values, scalar_columns, scalar_variables

MOST_JOBS = 200
router = APIRouter(prefix="/v1/scalars", tags=["results"])


class ScalarsQuery(Variables):
    """Which numbers of which jobs."""

    jobs: str = Field(min_length=1, max_length=27 * MOST_JOBS, examples=["01m7zns6je0661bz8g4vdfp4fq"],
                      description=f"Ids of jobs, at most {MOST_JOBS}, with commas between them")


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


@router.get("", response_model=ScalarsDocument, responses={**CONTENT, **problems(404, 422, 503)})
def scalars(query: Annotated[ScalarsQuery, Query()], parts: InParts, jobs: Jobs, accept: Accept = None) -> Response:
    """Variables that have no place along the rod, at the end of many jobs; but for JSON a table, a row for each job."""
    ids = [text.strip() for text in query.jobs.split(",")]
    if len(ids) > MOST_JOBS:
        raise Problem(422, "too_many_jobs", f"jobs must be at most {MOST_JOBS}, got {len(ids)}")
    with readable():
        names = scalar_variables(query.names)
    selected = [jobs.get(job_id) for job_id in ids]
    values = values_of(selected, names, jobs, parts)
    name, form = format_of(query.format, accept)
    if name != "json":
        return response_of(Part(job_columns(selected), scalar_columns(names, values)), form)
    documents = [ScalarsOfJob(id=job.id, label=job.label, status=job.status, outcome=job.outcome, t=job.t, values=last)
                 for job, last in zip(selected, values, strict=True)]  # fmt: skip
    return Response(ScalarsDocument(jobs=documents).model_dump_json(), media_type=form.media_type)


def values_of(selected: Sequence[Job], names: Sequence[str], jobs: Registry, parts: Parts) -> list[dict[str, Value]]:
    """The last values of jobs. Raises Problem 404 or 503 where only a dataset tells them, and that is not there."""
    stored = jobs.scalars({job.id for job in selected if job.dataset is not None})
    return [_scalars_of(job, names, stored.get(job.id), parts) for job in selected]


def _scalars_of(job: Job, names: Sequence[str], stored: Mapping[str, Value] | None, parts: Parts) -> dict[str, Value]:
    if job.dataset is None:
        return dict.fromkeys(names)
    if stored is not None:
        return {name: stored.get(name) for name in names}
    published = dataset_of(job, parts)
    with available(job, parts):
        path = parts.datasets.file(published.file, published.bytes, published.sha256)
    return last_values(path, names)


def job_columns(jobs: Sequence[Job], along: str = "job") -> tuple[Column, ...]:
    """What is said of each job beside its values, along one dimension."""
    facts = {"id": str, "label": str, "status": str, "outcome": str, "t": float}
    return tuple(Column(name, (along,), np.array([kind(getattr(job, name)) for job in jobs], kind),
                        {"units": "s"} if name == "t" else {}) for name, kind in facts.items())  # fmt: skip
