"""/ is the dashboard, /healthz says whether the service can do its work."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fastapi import APIRouter, Response
from fastapi.responses import FileResponse
from sqlalchemy.exc import SQLAlchemyError

from service.api.parts import InParts

POLICY = "default-src 'self'; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
DASHBOARD = Path(__file__).parent.parent / "dashboard" / "index.html"
router = APIRouter()


@router.get("/", include_in_schema=False)
def dashboard() -> FileResponse:
    """The page that shows the jobs."""
    return FileResponse(DASHBOARD, headers={"Content-Security-Policy": POLICY})


@router.get("/healthz", tags=["service"])
def health(parts: InParts, response: Response) -> dict[str, Any]:
    """State of database and broker. Without a broker jobs wait; without a database, the answer is 503."""
    try:
        parts.registry.page(1)
        database = "ok"
    except SQLAlchemyError:
        database = "unreachable"
        response.status_code = 503
    broker = "ok" if parts.doorbell.reachable() else "unreachable"
    status = "ok" if (database, broker) == ("ok", "ok") else "degraded"
    return {"status": status, "database": database, "broker": broker}
