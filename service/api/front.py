"""/ is the dashboard; /livez and /readyz (also /healthz) say whether the service lives, and can do its work."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from fastapi import APIRouter, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel

from service.api.health import Kept, Led, Reached, Room, Workers
from service.api.parts import InParts
from service.api.problems import Problem

POLICY = "default-src 'self'; img-src 'self' data: blob:; base-uri 'none'; form-action 'self'; frame-ancestors 'none'"
FRESH = {"Cache-Control": "no-cache", "X-Content-Type-Options": "nosniff"}
DASHBOARD = Path(__file__).parent.parent / "dashboard"
KINDS = {".js": "text/javascript", ".css": "text/css"}
PARTS = {path.relative_to(DASHBOARD).as_posix(): path for path in DASHBOARD.rglob("*.*") if path.suffix in KINDS}
"""The dashboard's modules and style by their paths."""
router = APIRouter()

class Readiness(BaseModel):
    """State of the parts. Without a broker or workers jobs wait; without a database that takes writes, or a disk with
    room, nothing works. `standing_still` names processes, and parts of them, that do not get on or are lost."""

    status: Literal["ok", "degraded"]
    database: Kept
    broker: Reached
    disk: Room
    workers: Workers
    leader: Led
    standing_still: list[str]


@router.get("/", include_in_schema=False)
def dashboard() -> FileResponse:
    """The page that shows the jobs."""
    return FileResponse(DASHBOARD / "index.html", headers={"Content-Security-Policy": POLICY, **FRESH})


@router.get("/dashboard/{name:path}", include_in_schema=False)
def part(name: str) -> FileResponse:
    """A module or the style of that page."""
    if name not in PARTS:
        raise Problem(404, "not_found", f"the dashboard has no part {name[:80]!r}")
    return FileResponse(PARTS[name], media_type=KINDS[PARTS[name].suffix], headers=FRESH)


@router.get("/livez", tags=["service"])
async def alive() -> Literal["ok"]:
    """This process answers: if it does not, start it again."""
    return "ok"


@router.get("/healthz", include_in_schema=False)
@router.get("/readyz", tags=["service"], responses={503: {"model": Readiness, "description": "No database, no room"}})
def ready(parts: InParts, response: Response) -> Readiness:
    """Whether jobs can be taken: 200 with a database that takes writes and a disk with room, else 503; what else does
    not get on is told: `status` is `ok` only where all does."""
    health = parts.health
    states = {"database": health.database, "broker": health.broker, "disk": health.disk, "workers": health.workers,
              "leader": health.leader}  # fmt: skip
    still = health.silent
    good = not still and set(states.values()) == {"ok"}
    if (states["database"], states["disk"]) != ("ok", "ok"):
        response.status_code = 503
    return Readiness.model_validate(states | {"status": "ok" if good else "degraded", "standing_still": still})
