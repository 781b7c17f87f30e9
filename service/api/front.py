"""/ is the dashboard; /livez and /readyz (also /healthz) say whether the service lives, and can do its work."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Literal

from fastapi import APIRouter, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel
from sqlalchemy.exc import SQLAlchemyError

from service.api.parts import InParts
from service.api.problems import Problem

POLICY = "default-src 'self'; img-src 'self' data: blob:; base-uri 'none'; form-action 'self'; frame-ancestors 'none'"
FRESH = {"Cache-Control": "no-cache", "X-Content-Type-Options": "nosniff"}
LEAST_FREE = 50_000_000
"""Bytes of free disk, below which no job is sure to be kept."""
DASHBOARD = Path(__file__).parent.parent / "dashboard"
KINDS = {".js": "text/javascript", ".css": "text/css"}
PARTS = {path.name: path for path in DASHBOARD.iterdir() if path.suffix in KINDS}
"""The dashboard's modules and style by name."""
router = APIRouter()

Reached = Literal["ok", "unreachable"]
Room = Literal["ok", "full"]


class Readiness(BaseModel):
    """State of database, broker and disk. Without a broker jobs wait; without a database or disk nothing works."""

    status: Literal["ok", "degraded"]
    database: Reached
    broker: Reached
    disk: Room


@router.get("/", include_in_schema=False)
def dashboard() -> FileResponse:
    """The page that shows the jobs."""
    return FileResponse(DASHBOARD / "index.html", headers={"Content-Security-Policy": POLICY, **FRESH})


@router.get("/dashboard/{name}", include_in_schema=False)
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
    """Whether jobs can be taken: 200 with a database and a disk with room, else 503; a missing broker is told."""
    database: Reached = "ok"
    try:
        parts.registry.page(1)
    except SQLAlchemyError:
        database = "unreachable"
        response.status_code = 503
    broker: Reached = "ok" if parts.doorbell.reachable() else "unreachable"
    disk: Room = "ok" if shutil.disk_usage(parts.settings.data).free >= LEAST_FREE else "full"
    if disk == "full":
        response.status_code = 503
    status: Literal["ok", "degraded"] = "ok" if (database, broker, disk) == ("ok", "ok", "ok") else "degraded"
    return Readiness(status=status, database=database, broker=broker, disk=disk)
