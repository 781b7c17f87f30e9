"""Without keys, only this machine may talk to the service, and no web page from elsewhere through it."""

from __future__ import annotations

from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from service.api.listening import is_loopback
from service.api.problems import Problem

READING = ("GET", "HEAD", "OPTIONS")


class LoopbackGuard:
    """Refuses a Host that is not loopback (DNS rebinding), and a write whose Origin is another site."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer with a problem, or pass the request on."""
        problem = _objection(scope["method"], Headers(scope=scope)) if scope["type"] == "http" else None
        await (problem.response() if problem else self._app)(scope, receive, send)


def _objection(method: str, headers: Headers) -> Problem | None:
    host, origin = headers.get("host", ""), headers.get("origin")
    if not is_loopback(_name_in(f"//{host}")):
        return Problem(421, "foreign_host", f"Host must be a loopback address, got {host[:80]!r}")
    if method not in READING and origin is not None and origin != f"http://{host}":
        return Problem(403, "foreign_origin", f"Origin must be http://{host}, got {origin[:80]!r}")
    return None


def _name_in(url: str) -> str:
    try:
        return urlsplit(url).hostname or ""
    except ValueError:
        return ""
