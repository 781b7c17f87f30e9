"""/ is the dashboard; /livez and /readyz (also /healthz) say whether the service lives, and can do its work."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from fastapi import APIRouter, Response
from fastapi.responses import FileResponse
from pydantic import BaseModel
from sqlalchemy.exc import SQLAlchemyError

from service.api.parts import InParts

POLICY = "default-src 'self'; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
DASHBOARD = Path(__file__).parent.parent / "dashboard" / "index.html"
router = APIRouter()

Reached = Literal["ok", "unreachable"]


class Readiness(BaseModel):
    """State of database and broker. Without a broker jobs wait; without a database nothing works."""

    status: Literal["ok", "degraded"]
    database: Reached
    broker: Reached


@router.get("/", include_in_schema=False)
def dashboard() -> FileResponse:
    """The page that shows the jobs."""
    return FileResponse(DASHBOARD, headers={"Content-Security-Policy": POLICY})


@router.get("/livez", tags=["service"])
async def alive() -> Literal["ok"]:
    """This process answers: if it does not, start it again."""
    return "ok"


@router.get("/healthz", include_in_schema=False)
@router.get("/readyz", tags=["service"], responses={503: {"model": Readiness, "description": "No database"}})
def ready(parts: InParts, response: Response) -> Readiness:
    """Whether jobs can be taken: 200 with a database, 503 without; a missing broker is told of."""
    database: Reached = "ok"
    try:
        parts.registry.page(1)
    except SQLAlchemyError:
        database = "unreachable"
        response.status_code = 503
    broker: Reached = "ok" if parts.doorbell.reachable() else "unreachable"
    status: Literal["ok", "degraded"] = "ok" if (database, broker) == ("ok", "ok") else "degraded"
    return Readiness(status=status, database=database, broker=broker)
