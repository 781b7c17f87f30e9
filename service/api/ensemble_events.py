"""/v1/ensembles/{id}/events: what happens to an ensemble, as it happens (server-sent events)."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncGenerator
from typing import Annotated, Any

from fastapi import APIRouter, Header, Response
from fastapi.responses import StreamingResponse

from service.api.description import problems
from service.api.ensembles import VisibleEnsembles, document, ensemble_of, member_document
from service.api.events import STILL_HERE, STREAM, event
from service.api.numbers import WHOLE
from service.api.parts import InParts, Reader
from service.jobs import Status
from service.jobs.ensembles import Ensemble, Ensembles

LOOK = 0.5
"""Seconds between two looks at the members."""
DESCRIPTION = (
    "Events until all members have ended: `member`, with a member whose status has changed (first, all that do not "
    "just wait); `progress`, with the whole ensemble."
)
EVENTS: dict[int | str, dict[str, Any]] = {200: STREAM[200] | {"description": DESCRIPTION},
          204: {"description": "All members have ended, and nothing has changed since Last-Event-ID."}}
router = APIRouter(prefix="/v1/ensembles/{ensemble_id}", tags=["ensembles"])


@router.get("/events", response_class=Response, responses={**EVENTS, **problems(404, 422)})
def ensemble_events(
    ensemble_id: str, ensembles: VisibleEnsembles, parts: InParts, caller: Reader,
    last_event_id: Annotated[int, Header(alias="Last-Event-ID", ge=0, le=2**62), WHOLE] = 0,
) -> Response:
    """Follow an ensemble. Each event says how something is now, not what has changed: after a break with
    Last-Event-ID, all that does not just wait is told again, if anything has changed since."""
    ensemble = ensemble_of(ensembles, ensemble_id)
    standing = ensembles.standing(ensemble.id)
    if standing.ended and last_event_id >= standing.version:
        return Response(status_code=204)
    stream = parts.admitted.while_good(caller, _stream(ensembles, ensemble, last_event_id))
    return StreamingResponse(stream, media_type="text/event-stream",
                             headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"})


async def _stream(ensembles: Ensembles, ensemble: Ensemble, seen: int) -> AsyncGenerator[str, None]:
    statuses: dict[int, Status] = {}
    spoke = time.monotonic()
    while True:
        version = await asyncio.to_thread(ensembles.version, ensemble.id)
        if version > seen:
            text, ended = await asyncio.to_thread(_changes, ensembles, ensemble, statuses)
            yield text
            seen, spoke = version, time.monotonic()
            if ended:
                return
        elif time.monotonic() - spoke > STILL_HERE:
            yield ": still here\n\n"
            spoke = time.monotonic()
        await asyncio.sleep(LOOK)


def _changes(ensembles: Ensembles, ensemble: Ensemble, statuses: dict[int, Status]) -> tuple[str, bool]:
    """The events of what is not as in `statuses`, which are brought up to date; and whether all have ended."""
    standing = ensembles.standing(ensemble.id)  # first: what the members say is newer
    events = []
    for member in ensembles.members(ensemble.id):
        if member.job.status is not statuses.get(member.number, Status.ACCEPTED):
            events.append(event(standing.version, "member", member_document(ensemble, member).model_dump(mode="json")))
        statuses[member.number] = member.job.status
    events.append(event(standing.version, "progress", document(ensemble, standing).model_dump(mode="json")))
    return "".join(events), standing.ended
