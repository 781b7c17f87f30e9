"""/v1/jobs/{id}/film: what a moving picture of the rod needs."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field

from service.api.data import part_of
from service.api.description import problems
from service.api.parts import InParts, Jobs
from service.results.film import film as film_of

KIND = "application/octet-stream"
CONTENT: dict[int | str, dict[str, Any]] = {200: {
    "content": {KIND: {"schema": {"type": "string", "format": "binary"}}},
    "description": "The length of a JSON header (4 bytes, little-endian), the header, and little-endian float32 "
    "numbers: of each of its `blocks` all frames, nodes and components"}}  # fmt: skip
router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])


class FilmQuery(BaseModel):
    """Which frames."""

    model_config = ConfigDict(extra="forbid")
    since: float | None = Field(None, allow_inf_nan=False, description="only frames after this time, in s")


@router.get("/film", response_class=Response, responses={**CONTENT, **problems(404, 409, 422, 503)})
def film(job_id: str, query: Annotated[FilmQuery, Query()], parts: InParts, jobs: Jobs) -> Response:
    """Positions, orientations and the numbers that colour them, thinned out to what can be drawn; of a job that still
    runs, the frames so far."""
    _, content = part_of(job_id, jobs, parts, lambda source: film_of(source, query.since))
    return Response(content, media_type=KIND, headers={"Cache-Control": "no-cache"})
