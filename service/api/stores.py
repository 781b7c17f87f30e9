"""/v1/jobs/{id}/zarr and /v1/jobs/{id}/opendap: the dataset for programs that open it where it is, part by part."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Request, Response

from service.api.datasets import available, dataset_of
from service.api.description import problems
from service.api.formats import readable
from service.api.parts import InParts, Jobs, Parts
from service.api.problems import Problem
from service.jobs import Job
from service.results.opendap import BadConstraint, DapDataset
from service.results.query import DatasetSource, opened
from service.results.zarr import NoSuchKey, ZarrStore

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])
Dap = Literal["dds", "das", "dods"]
DAP = {"XDAP": "2.0", "XDODS-Server": "hockle"}
BINARY = {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}
BYTES: dict[int | str, dict[str, Any]] = {200: {"description": "The value", "content": BINARY}}
TEXT: dict[int | str, dict[str, Any]] = {
    200: {"description": "As DAP 2.0 writes it", "content": {"text/plain": {"schema": {"type": "string"}}}}
}


@router.get("/zarr/{key:path}", response_class=Response, responses={**BYTES, **problems(404, 409, 503)})
def zarr(job_id: str, key: Annotated[str, Path(max_length=200)], parts: InParts, jobs: Jobs) -> Response:
    """A key of the dataset as a Zarr store, version 3: `xarray.open_zarr(address of /v1/jobs/ID/zarr)` reads what it
    needs, when it needs it."""
    return zarr_of(jobs.get(job_id), key, parts)


def zarr_of(job: Job, key: str, parts: Parts) -> Response:
    """What lies at a key of a job's store. Raises Problem."""
    try:
        content = _read(job, parts, lambda source: ZarrStore(source).get(key))
    except NoSuchKey:
        raise Problem(404, "no_such_key", f"the store of job {job.id} has no key {key[:80]!r}") from None
    kind = "application/json" if key.endswith("zarr.json") else "application/octet-stream"
    return Response(content, media_type=kind, headers={"Cache-Control": "private, immutable"})


@router.get("/opendap.dds", response_class=Response, responses={**TEXT, **problems(404, 409, 422, 503)})
def opendap_structure(job_id: str, request: Request, parts: InParts, jobs: Jobs) -> Response:
    """What the dataset holds, as OPeNDAP (DAP 2.0) has it: `xarray.open_dataset(address of /v1/jobs/ID/opendap)`."""
    return dap_of(jobs.get(job_id), "dds", request.url.query, parts)


@router.get("/opendap.das", response_class=Response, responses={**TEXT, **problems(404, 409, 503)})
def opendap_attributes(job_id: str, parts: InParts, jobs: Jobs) -> Response:
    """The attributes of the dataset, as OPeNDAP has them."""
    return dap_of(jobs.get(job_id), "das", "", parts)


@router.get("/opendap.dods", response_class=Response, responses={**BYTES, **problems(404, 409, 422, 503)})
def opendap_values(job_id: str, request: Request, parts: InParts, jobs: Jobs) -> Response:
    """The values that a constraint in the query asks for, as `r[0:1:9][0:10:100][0:1:2]`: at most ten million."""
    return dap_of(jobs.get(job_id), "dods", request.url.query, parts)


def dap_of(job: Job, what: Dap, constraint: str, parts: Parts) -> Response:
    """A job's dataset by OPeNDAP: its structure, its attributes or its values. Raises Problem."""
    make: dict[Dap, Callable[[DapDataset], bytes]] = {
        "dds": lambda dataset: dataset.dds(constraint), "das": lambda dataset: dataset.das(),
        "dods": lambda dataset: dataset.dods(constraint),
    }  # fmt: skip
    try:
        with readable():
            content = _read(job, parts, lambda source: make[what](DapDataset(job.id, source)))
    except BadConstraint as error:
        raise Problem(422, "bad_constraint", str(error)) from None
    kind = "application/octet-stream" if what == "dods" else "text/plain"
    return Response(content, media_type=kind, headers={**DAP, "Content-Description": f"dods_{what}"})


def _read(job: Job, parts: Parts, make: Callable[[DatasetSource], bytes]) -> bytes:
    published = dataset_of(job, parts)
    with available(job, parts):
        path = parts.datasets.file(published.file, published.bytes, published.sha256)
    with available(job, parts), opened(path) as source:
        return make(source)
