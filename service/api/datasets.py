"""/v1/jobs/{id}/dataset: the file."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse, StreamingResponse
from starlette.responses import MalformedRangeHeader, RangeNotSatisfiable

from service.api.description import NOT_MODIFIED, problems
from service.api.parts import InParts, Jobs, Parts, matches
from service.api.problems import Problem
from service.jobs import ENDED, Dataset, Job
from service.results import StoreUnreachable
from service.results.bucket import Bucket
from service.store import look, lost
from service.store.verification import MISSING

NETCDF = "application/x-netcdf"
BINARY = {NETCDF: {"schema": {"type": "string", "format": "binary"}}}
FILE: dict[int | str, dict[str, Any]] = {
    200: {"description": "The file", "content": BINARY},
    206: {"description": "A range of it", "content": BINARY | {"multipart/byteranges": {"schema": {"type": "string"}}}},
}
router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])
log = logging.getLogger(__name__)


class DatasetFile(FileResponse):
    """A file whose Range header is taken as RFC 9110 says: what is none is ignored."""

    chunk_size = 1_000_000  # each one is a way to a thread and back

    @classmethod
    def _parse_range_header(cls, http_range: str, file_size: int) -> list[tuple[int, int]]:
        try:
            return super()._parse_range_header(http_range, file_size)
        except MalformedRangeHeader:
            return []
        except RangeNotSatisfiable:
            raise Problem(416, "range_not_satisfiable", f"there are {file_size} bytes, got {http_range!r}",
                          {"Content-Range": f"bytes */{file_size}"}) from None


@router.head("/dataset", include_in_schema=False)
@router.get("/dataset", response_class=FileResponse, responses={**FILE, **NOT_MODIFIED, **problems(404, 409, 416, 503)})
def dataset(job_id: str, request: Request, parts: InParts, jobs: Jobs) -> Response:
    """The NetCDF file, whole or by byte ranges; its ETag is its sha256. xarray opens it by this address with
    `#mode=bytes`."""
    return whole(jobs.get(job_id), request, parts)


def whole(job: Job, request: Request, parts: Parts) -> Response:
    """A job's file as an answer. Raises Problem."""
    published = dataset_of(job, parts)
    headers = {"ETag": f'"{published.sha256}"', "Cache-Control": "private, immutable"}
    if matches(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    headers["Content-Disposition"] = f'attachment; filename="{job.id}.nc"'
    with available(job, parts):
        place = parts.datasets.find(published.file)
        if isinstance(place, Bucket):
            return _object(place, published, request, headers)
    return DatasetFile(place, headers=headers, media_type=NETCDF)


def _object(bucket: Bucket, published: Dataset, request: Request, headers: dict[str, str]) -> Response:
    """What DatasetFile gives, from an object."""
    size = published.bytes
    part = _one_range(request, headers["ETag"], size)
    start, stop = part or (0, size)
    headers |= {"Accept-Ranges": "bytes", "Content-Length": str(stop - start)}
    if part:
        headers["Content-Range"] = f"bytes {start}-{stop - 1}/{size}"
    content = () if request.method == "HEAD" else bucket.read(published.file, start, stop)
    return StreamingResponse(content, 206 if part else 200, headers, NETCDF)


def _one_range(request: Request, etag: str, size: int) -> tuple[int, int] | None:
    """The first byte that is wanted, and the one after the last; of several ranges the whole, as RFC 9110 allows."""
    if request.headers.get("if-range", etag) != etag:
        return None
    ranges = DatasetFile._parse_range_header(request.headers.get("range", ""), size)
    return ranges[0] if len(ranges) == 1 else None


def dataset_of(job: Job, parts: Parts) -> Dataset:
    """What the job has published, and is still good. Raises Problem 404, 409 or 503."""
    with available(job, parts):
        published = look(parts.registry.database, parts.datasets, job)
    if published is not None and published.fault:
        raise _lost(job, published.fault)
    if published is not None:
        return published
    if job.status in ENDED:
        raise Problem(404, "no_dataset", f"job {job.id} is {job.status} and has no dataset: {job.message}")
    raise not_finished(job, "its dataset comes at its end")


def not_finished(job: Job, reason: str) -> Problem:
    """What is told of a job that has not got so far."""
    return Problem(409, "not_finished", f"job {job.id} is {job.status}: {reason}", {"Retry-After": "1"})


@contextmanager
def available(job: Job, parts: Parts) -> Iterator[None]:
    """While its dataset is looked for. Raises Problem 404 where it is lost, 503 where it cannot be read now."""
    try:
        yield
    except FileNotFoundError:
        lost(parts.registry.database, job)
        raise _lost(job, MISSING) from None
    except StoreUnreachable as error:
        log.warning("job %s: its dataset cannot be read: %s", job.id, error)
        raise Problem(503, "store_unreachable", "the object store that holds the dataset cannot give it now: ask later",
                      {"Retry-After": "5"}) from None


def _lost(job: Job, fault: str) -> Problem:
    return Problem(404, "dataset_lost", f"the dataset of job {job.id} is {fault}: submit its case again")
