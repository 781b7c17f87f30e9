"""What every request passes before any route: Host, Origin, API key, rate limit, parameters that come once."""

from __future__ import annotations

import ipaddress
import logging
import time
from collections.abc import Collection
from math import ceil
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.access import Caller, Refused, authenticate
from service.access.limits import Grant
from service.api.listening import is_loopback
from service.api.once import check_once
from service.api.problems import Problem, unreachable

if TYPE_CHECKING:
    from service.api.parts import Parts

READING = ("GET", "HEAD", "OPTIONS")
OPEN_TO_ALL = frozenset({"/", "/healthz", "/livez", "/readyz", "/v1/openapi.json", "/docs"})
SHARED = "/v1/shared/"
"""Below it no key is asked for: the address itself lets in."""
DASHBOARD = "/dashboard/"
"""The program of the page that asks for the key."""
DOCUMENTATION = "/docs/"
SAFE = [
    (b"x-content-type-options", b"nosniff"), (b"x-frame-options", b"DENY"), (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"), (b"cross-origin-resource-policy", b"same-origin"),
    (b"permissions-policy", b"camera=(), geolocation=(), microphone=()"),
]
"""What every answer tells a browser."""
NOTHING = (b"content-security-policy", b"default-src 'none'; frame-ancestors 'none'")
"""What an answer that is no page may load or do, should a browser show it."""
log = logging.getLogger(__name__)


class Gate:
    """Refuses a foreign Host (DNS rebinding), a write from another site's page, a bad key, haste, a repeated parameter.

    What passes has its caller in `scope["caller"]`. `keyed`: whether a key is required;
    `hosts`: the names of this service beside its addresses.
    """

    def __init__(self, app: ASGIApp, keyed: bool, hosts: Collection[str]) -> None:
        self._app, self._keyed, self._hosts = app, keyed, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer with a problem, or pass the request on."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        send = _safely(send)
        try:
            if grant := self._let_in(scope, Headers(scope=scope)):
                send = _telling(send, grant)
            check_once(scope["query_string"])
        except Exception as error:
            problem = error if isinstance(error, Problem) else unreachable(error)
            if problem is None:
                raise
            log.info("refused", extra={"problem": problem.name, "method": scope["method"], "path": scope["path"]})
            await problem.response()(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    def _let_in(self, scope: Scope, headers: Headers) -> Grant | None:
        if len(headers.getlist("host")) != 1:
            raise Problem(400, "one_host", "a request must have one Host header")
        self._check_host(headers.get("host", ""))
        _check_origin(scope["method"], headers.get("host", ""), headers.get("origin"))
        if is_open(scope["path"]):
            return None
        parts: Parts = scope["app"].state.parts
        scope["caller"] = caller = _caller(headers.get("authorization"), parts, self._keyed)
        if not caller.key:
            return None
        grant = parts.rate.ask(caller.owner)
        if grant.wait > 0:
            raise Problem(429, "too_many_requests", f"{caller.owner} asks too often: wait {grant.wait:.2f} s",
                          {"Retry-After": str(ceil(grant.wait)), **_limits(grant)})
        return grant

    def _check_host(self, host: str) -> None:
        name = _name_in(host)
        if is_loopback(name) or name in self._hosts or (self._keyed and _is_address(name)):
            return
        expected = "a name of this service (HOCKLE_HOSTS)" if self._keyed else "a loopback address"
        raise Problem(421, "foreign_host", f"Host must be {expected}, got {host[:80]!r}")


def is_open(path: str) -> bool:
    """Whether no key is asked for at this path."""
    return path in OPEN_TO_ALL or path.startswith((SHARED, DASHBOARD, DOCUMENTATION))


def _check_origin(method: str, host: str, origin: str | None) -> None:
    if method not in READING and origin not in (None, f"http://{host}", f"https://{host}"):
        raise Problem(403, "foreign_origin", f"Origin must be that of {host}, got {origin[:80]!r}")


def _caller(authorization: str | None, parts: Parts, keyed: bool) -> Caller:
    try:
        return authenticate(authorization, parts.keys.find, keyed, time.time())
    except Refused as refused:
        raise Problem(401, "not_authenticated", str(refused), {"WWW-Authenticate": "Bearer"}) from None


def _telling(send: Send, grant: Grant) -> Send:
    """Send with the RateLimit headers in the answer."""

    async def tell(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).update(_limits(grant))
        await send(message)

    return tell


def _safely(send: Send) -> Send:
    """Send with the headers that keep browsers from doing more with an answer than they should."""

    async def tell(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = message.setdefault("headers", [])
            present = {name for name, _ in headers}
            headers += [header for header in (*SAFE, NOTHING) if header[0] not in present]
        await send(message)

    return tell


def _limits(grant: Grant) -> dict[str, str]:
    """As draft-ietf-httpapi-ratelimit-headers-10 spells them."""
    return {"RateLimit-Policy": f'"owner";q={grant.burst};w={ceil(grant.window)}',
            "RateLimit": f'"owner";r={grant.remaining};t={ceil(grant.reset)}'}


def _name_in(host: str) -> str:
    """The name that a Host header gives, without its port; nothing where it is more than these (RFC 9110, 7.2)."""
    try:
        parts = urlsplit(f"//{host}")
        name, _ = parts.hostname, parts.port
    except ValueError:  # of the port, too
        return ""
    return name if name and parts.netloc == host and "@" not in host else ""


def _is_address(name: str) -> bool:
    """Whether it is an address: only names can be rebound to another one."""
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
