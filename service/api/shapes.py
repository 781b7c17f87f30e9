"""/v1/jobs/{id}/vtk and /v1/jobs/{id}/gltf: the moving rod for other programs."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Query, Response
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from service.api.data import part_of
from service.api.description import problems
from service.api.numbers import WHOLE
from service.api.parts import InParts, Jobs
from service.cases import parse_case
from service.cases.quantities import curve
from service.jobs import Registry
from service.results.gltf import glb
from service.results.vtk import vtk_archive

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])
ZIP, GLB = "application/zip", "model/gltf-binary"


class Frames(BaseModel):
    """Which frames."""

    model_config = ConfigDict(extra="forbid")
    time_stride: Annotated[int, Field(ge=1, le=2**31), WHOLE] = 1


def _file(kind: str) -> dict[int | str, dict[str, Any]]:
    return {200: {"description": "The file", "content": {kind: {"schema": {"type": "string", "format": "binary"}}}}}


@router.get("/vtk", response_class=Response, responses={**_file(ZIP), **problems(404, 409, 422, 503)})
def vtk(job_id: str, frames: Annotated[Frames, Query()], parts: InParts, jobs: Jobs) -> Response:
    """The frames for ParaView: a ZIP archive of `rod.pvd` and a VTP file for each time, a line with all that is stored
    along it and its radius. Of a job that runs the frames so far."""
    job, content = part_of(job_id, jobs, parts, lambda source: vtk_archive(
        source, _radius(job_id, jobs, source.s), frames.time_stride))
    return _download(content, ZIP, f"{job.id}-vtk.zip")


@router.get("/gltf", response_class=Response, responses={**_file(GLB), **problems(404, 409, 422, 503)})
def gltf(job_id: str, parts: InParts, jobs: Jobs) -> Response:
    """The rod as a tube that moves, as binary glTF 2.0 (.glb), thinned out to 120 frames. Of a job that runs the frames
    so far."""
    job, content = part_of(job_id, jobs, parts, lambda source: glb(source, _radius(job_id, jobs, source.s)))
    return _download(content, GLB, f"{job.id}.glb")


def _radius(job_id: str, jobs: Registry, s: NDArray[np.float64]) -> NDArray[np.float64]:
    diameter = curve(parse_case(jobs.case(job_id)).rod.diameter)
    return np.array([0.5 * diameter.value(float(at)) for at in s])


def _download(content: bytes, kind: str, name: str) -> Response:
    return Response(content, media_type=kind, headers={"Content-Disposition": f'attachment; filename="{name}"'})
