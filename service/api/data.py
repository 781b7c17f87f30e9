"""/v1/jobs/{id}/data: some variables of a job, also while it runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, TypeVar

from fastapi import APIRouter, Query, Response

from service.api.datasets import available, dataset_of, not_finished
from service.api.description import problems
from service.api.formats import CONTENT, Accept, VariablesInRanges, format_of, readable, response_of
from service.api.parts import InParts, Jobs, Parts
from service.jobs import ENDED, Job, Registry
from service.results import subset
from service.results.live import LiveSource
from service.results.part import Part
from service.results.query import Source, opened

T = TypeVar("T")
router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])


@router.get("/data", response_class=Response, responses={**CONTENT, **problems(404, 409, 422, 503)})
def data(job_id: str, query: Annotated[VariablesInRanges, Query()], parts: InParts, jobs: Jobs,
         accept: Accept = None) -> Response:
    """Some variables over a range of time and arclength, as JSON, CSV, NetCDF or Arrow; of a job that still runs the
    frames so far, with the bits that its dataset will have. The header `Job-Status` says which of the two it was."""
    _, form = format_of(query.format, accept)

    def read(source: Source) -> Part:
        return subset(source, query.names, query.ranges, form.limit, form.table)

    job, part = part_of(job_id, jobs, parts, read)
    attributes = {"job": job.id, "status": job.status.value, "title": job.title}
    fresh = {"Job-Status": job.status.value} | ({} if job.status in ENDED else {"Cache-Control": "no-store"})
    return response_of(replace(part, attributes=attributes), form, fresh)


def part_of(job_id: str, jobs: Registry, parts: Parts, read: Callable[[Source], T]) -> tuple[Job, T]:
    """A job, and what `read` makes of its frames, or of those that it has so far.

    Raises Problem 404, 409, 422 or 503, UnknownJob.
    """
    job = jobs.get(job_id)
    if job.dataset is None and job.status not in ENDED:
        try:
            with readable():
                return job, read(LiveSource.of(parts.settings.work / job.id))
        except FileNotFoundError:  # there is none yet, or the job has just ended
            job = jobs.get(job_id)
    if job.dataset is None and job.status not in ENDED:
        raise not_finished(job, "its first frames are not there yet")
    published = dataset_of(job, parts)
    with available(job, parts):
        path = parts.datasets.file(published.file, published.bytes, published.sha256)
    with available(job, parts), readable(), opened(path) as source:
        return job, read(source)
