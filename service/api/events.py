"""/v1/jobs/{id}/events: what happens to a job, as it happens (server-sent events)."""

from __future__ import annotations

import json
from collections.abc import AsyncGenerator
from datetime import UTC, datetime
from typing import Annotated, Any

from fastapi import APIRouter, Header, Response
from fastapi.responses import StreamingResponse

from service.api.description import problems
from service.api.documents import document
from service.api.feed import Feed
from service.api.numbers import WHOLE
from service.api.parts import InParts, Jobs, Reader
from service.jobs import ENDED, Registry

STILL_HERE = 15.0
EVENT = {
    "type": "object", "description": "Each event of the stream.",
    "properties": {"id": {"type": "string", "pattern": "^[0-9]+$"}, "event": {"type": "string"},
                   "data": {"type": "string", "contentMediaType": "application/json"}},
    "required": ["id", "event", "data"],
}  # fmt: skip
STREAM: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/event-stream": {"schema": EVENT}},
                "description": "Events until the job has ended: `accepted`, `started`, `cancel_requested`, "
                "`handed_back`, `taken_back`, `ended`, each with its time; and `progress` with the whole job."},
          204: {"description": "The job has ended, and there is nothing after Last-Event-ID."}}  # fmt: skip
router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["jobs"])


@router.get("/events", response_class=Response, responses={**STREAM, **problems(404, 422)})
async def events(job_id: str, parts: InParts, jobs: Jobs, caller: Reader,
                 last_event_id: Annotated[int, Header(alias="Last-Event-ID", ge=0, le=2**62), WHOLE] = 0) -> Response:
    """Follow a job; after a break, Last-Event-ID (the job's version that was seen last) goes on from there."""
    job = jobs.get(job_id)
    if job.status in ENDED and last_event_id >= job.version:
        return Response(status_code=204)
    stream = parts.admitted.while_good(caller, _stream(jobs, parts.feed, job_id, last_event_id))
    return StreamingResponse(stream, media_type="text/event-stream",
                             headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"})


async def _stream(jobs: Registry, feed: Feed, job_id: str, seen: int) -> AsyncGenerator[str, None]:
    while True:
        job = jobs.get(job_id)
        for entry in jobs.events(job_id, seen):
            seen = entry.seq
            yield event(seen, entry.kind, {"time": datetime.fromtimestamp(entry.time, UTC).isoformat(), **entry.data})
        if job.status in ENDED:
            return
        if job.version > seen:
            seen = job.version
            yield event(seen, "progress", document(job).model_dump(mode="json"))
        if not await feed.changed(job, STILL_HERE):
            yield ": still here\n\n"


def event(number: int, kind: str, data: dict[str, Any]) -> str:
    """An event as it is sent."""
    return f"id: {number}\nevent: {kind}\ndata: {json.dumps(data)}\n\n"
