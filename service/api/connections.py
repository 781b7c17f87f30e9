"""What a client may do to a connection before its request is whole: so long, so many bytes, so many connections.

Uvicorn bounds none of these with httptools, its faster parser: a half-sent request is kept for ever, with as many bytes
of headers as come. So its protocol is given deadlines and bounds here; the parsing stays uvicorn's.
"""

from __future__ import annotations

import asyncio
import resource
from collections import Counter
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

KEPT_BACK = 256
"""Descriptors that no client gets: for the registry, datasets that are served, the leader's lock."""
MOST_CONNECTIONS = 8192


@dataclass(frozen=True)
class Bounds:
    """Seconds within which a request's head and its body must be here, bytes and number of its headers, and connections
    in all and from one address."""

    head_within: float = 10.0
    body_within: float = 60.0
    header_bytes: int = 65_536
    headers: int = 100
    connections: int = MOST_CONNECTIONS
    per_address: int = MOST_CONNECTIONS // 2


def bounds_here() -> Bounds:
    """The bounds by the descriptors that this process may have, of which it takes as many as are useful."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = MOST_CONNECTIONS + KEPT_BACK
    soft = max(soft, wanted if hard == resource.RLIM_INFINITY else min(hard, wanted))
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    connections = max(min(soft - KEPT_BACK, MOST_CONNECTIONS), soft // 4)
    return Bounds(connections=connections, per_address=max(connections // 2, 1))


def bounded(bounds: Bounds) -> type[HttpToolsProtocol]:
    """Uvicorn's protocol within these bounds."""
    return type("Bounded", (_Bounded,), {"bounds": bounds, "addresses": Counter()})


class _Bounded(HttpToolsProtocol):
    bounds: Bounds
    addresses: Counter[str]

    def __init__(self, *parameters: Any, **named: Any) -> None:
        super().__init__(*parameters, **named)
        self._deadline: asyncio.TimerHandle | None = None
        self._address = ""
        self._refused = False
        self._head = 0
        """Bytes of the head that is being read; -1 while none is."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Let a connection in, or close it."""
        peer = transport.get_extra_info("peername")
        self._address = str(peer[0]) if peer else ""
        self.addresses[self._address] += 1
        many = self.addresses[self._address] > self.bounds.per_address
        if many or self.addresses.total() > self.bounds.connections:
            self._refused = True
            transport.abort()
            return
        super().connection_made(transport)
        self._by(self.bounds.head_within)

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
        self.addresses[self._address] -= 1
        if not self.addresses[self._address]:
            del self.addresses[self._address]
        self._by(None)
        if self.transport is not None:  # it was let in
            super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read on, as far as the bounds let it."""
        if self._refused:
            return
        if self._head >= 0:
            self._head += len(data)
        super().data_received(data)
        if self._head > self.bounds.header_bytes:
            self._refuse(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE)

    def on_message_begin(self) -> None:
        """A request begins."""
        super().on_message_begin()
        if self._head < 0:
            self._head = 0
        self._by(self.bounds.head_within)

    def on_headers_complete(self) -> None:
        """Its head is here."""
        size = len(self.url) + sum(len(name) + len(value) for name, value in self.headers)
        self._head = -1
        if len(self.headers) > self.bounds.headers or size > self.bounds.header_bytes:
            self._refuse(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE)
            return
        self._by(self.bounds.body_within)
        super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        """A part of its body is here."""
        if not self._refused:
            super().on_body(body)

    def on_message_complete(self) -> None:
        """All of it is here."""
        self._by(None)
        if not self._refused:
            super().on_message_complete()

    def _by(self, seconds: float | None) -> None:
        """Set the time by which the request must have come farther, or none."""
        if self._deadline is not None:
            self._deadline.cancel()
        self._deadline = None if seconds is None else self.loop.call_later(seconds, self._late)

    def _late(self) -> None:
        if self._head >= 0:
            self._refuse(HTTPStatus.REQUEST_TIMEOUT)
        else:
            self._refused = True
            self.transport.abort()

    def _refuse(self, status: HTTPStatus) -> None:
        """Answer, and close."""
        if self._refused:
            return
        self._refused = True
        self._by(None)
        head = f"HTTP/1.1 {status.value} {status.phrase}\r\ncontent-length: 0\r\nconnection: close\r\n\r\n"
        if not self.transport.is_closing():
            self.transport.write(head.encode())
            self.transport.close()
