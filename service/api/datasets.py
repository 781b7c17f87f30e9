"""/v1/jobs/{id}/dataset is the file, /v1/jobs/{id}/data a part of it as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel, ConfigDict, Field
from starlette.responses import MalformedRangeHeader, RangeNotSatisfiable

from service.api.description import NOT_MODIFIED, problems
from service.api.parts import InParts, Jobs, Parts, matches
from service.api.problems import Problem
from service.jobs import ENDED, Dataset, Registry
from service.results import SubsetTooLarge, UnknownVariable, subset

NETCDF = "application/x-netcdf"
BINARY = {NETCDF: {"schema": {"type": "string", "format": "binary"}}}
FILE: dict[int | str, dict[str, Any]] = {
    200: {"description": "The file", "content": BINARY},
    206: {"description": "A range of it", "content": BINARY | {"multipart/byteranges": {"schema": {"type": "string"}}}},
}
router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])


class Part(BaseModel):
    """Which part of a dataset: names with commas between, ranges in s and m, every n-th in time and s."""

    model_config = ConfigDict(extra="forbid")
    variables: str = Field(min_length=1, max_length=1000, examples=["Tw,Wr,Lk"])
    t_min: float | None = Field(None, allow_inf_nan=False)
    t_max: float | None = Field(None, allow_inf_nan=False)
    s_min: float | None = Field(None, allow_inf_nan=False)
    s_max: float | None = Field(None, allow_inf_nan=False)
    time_stride: int = Field(1, ge=1)
    s_stride: int = Field(1, ge=1)


class DatasetFile(FileResponse):
    """A file whose Range header is taken as RFC 9110 says: what is none is ignored."""

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
@router.get("/dataset", response_class=FileResponse, responses={**FILE, **NOT_MODIFIED, **problems(404, 409, 416)})
def dataset(job_id: str, request: Request, parts: InParts, jobs: Jobs) -> Response:
    """The NetCDF file, whole or by byte ranges; xarray opens it by this address with #mode=bytes."""
    path, published = _published(job_id, parts, jobs)
    headers = {"ETag": f'"{published.sha256}"', "Cache-Control": "private, immutable"}
    if matches(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return DatasetFile(path, headers=headers, media_type=NETCDF, filename=f"{job_id}.nc")


@router.get("/data", responses=problems(404, 409, 422))
def data(job_id: str, part: Annotated[Part, Query()], parts: InParts, jobs: Jobs) -> dict[str, Any]:
    """Some variables over a range of time and arclength, as JSON."""
    path, _ = _published(job_id, parts, jobs)
    told = part.model_dump()
    names = [name.strip() for name in told.pop("variables").split(",")]
    try:
        return subset(path, names, **told)
    except SubsetTooLarge as error:
        raise Problem(422, "subset_too_large", str(error)) from None
    except UnknownVariable as error:
        raise Problem(422, "unknown_variable", str(error)) from None


def _published(job_id: str, parts: Parts, jobs: Registry) -> tuple[Path, Dataset]:
    """The job's file. Raises Problem 404 or 409, UnknownJob."""
    job = jobs.get(job_id)
    if job.dataset is None and job.status not in ENDED:
        raise Problem(409, "not_finished", f"job {job.id} is {job.status}: its dataset comes at its end",
                      {"Retry-After": "1"})
    path = parts.settings.datasets / job.dataset.file if job.dataset else None
    if job.dataset is None or path is None or not path.is_file():
        raise Problem(404, "no_dataset", f"job {job.id} is {job.status} and has no dataset: {job.message}")
    return path, job.dataset
