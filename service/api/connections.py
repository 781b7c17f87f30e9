"""What a client may do to a connection: so long for a request to be whole and for its answer to be read, so many bytes
beside bodies, so many requests that wait, so many connections.

Uvicorn bounds none of these with httptools, its faster parser: a half-sent request is kept for ever, with as many bytes
of headers as come, and so is an answer that nobody reads. So its protocol is given deadlines and bounds here; the
parsing stays uvicorn's.
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
    """Seconds within which a request's head and its body must be here, and within which some of an answer must be read;
    bytes and number of its headers; requests of a connection that wait for the answer to the one before; and
    connections in all and from one address."""

    head_within: float = 10.0
    body_within: float = 60.0
    read_within: float = 60.0
    header_bytes: int = 65_536
    headers: int = 100
    waiting: int = 16
    connections: int = MOST_CONNECTIONS
    per_address: int = MOST_CONNECTIONS // 2


def bounds_here() -> Bounds:
    """The bounds by the descriptors that this process may have, of which it takes as many as are useful: two for each
    connection, whose answer may be a file."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    descriptors = 2 * MOST_CONNECTIONS + KEPT_BACK
    soft = max(soft, descriptors if hard == resource.RLIM_INFINITY else min(hard, descriptors))
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    connections = max(min((soft - KEPT_BACK) // 2, MOST_CONNECTIONS), soft // 4)
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
        self._within: float | None = None
        self._moved = False
        """Whether the deadline is another one since bytes came: its timer is set when all of them are read, so that a
        request that is here at once needs none."""
        self._reader: asyncio.TimerHandle | None = None
        self._address = ""
        self._refused = False
        self._in_head = True
        self._beside = 0
        """Bytes since a request, or a part of its body, began: of a head, of a chunk's head, of a trailer."""

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
        transport.set_write_buffer_limits(0)  # be told of whatever is not read at once
        super().connection_made(transport)
        self._by(self.bounds.head_within)
        self._set_timer()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
        self.addresses[self._address] -= 1
        if not self.addresses[self._address]:
            del self.addresses[self._address]
        self._by(None)
        self._set_timer()
        if self._reader is not None:
            self._reader.cancel()
        if self.transport is not None:  # it was let in
            super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read on, as far as the bounds let it."""
        if self._refused:
            return
        self._beside += len(data)
        if self._deadline is None and (self.cycle is None or self.cycle.response_complete):
            self._by(self.bounds.head_within)  # else what is no request would be waited for
        super().data_received(data)
        if self._beside > self.bounds.header_bytes:
            self._refuse(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE)
        self._set_timer()

    def on_message_begin(self) -> None:
        """A request begins."""
        super().on_message_begin()
        if not self._in_head:
            self._in_head, self._beside = True, 0
        self._by(self.bounds.head_within)

    def on_header(self, name: bytes, value: bytes) -> None:
        """A header is here; what comes after the body is none."""
        if self._in_head:
            super().on_header(name, value)

    def on_headers_complete(self) -> None:
        """Its head is here."""
        size = len(self.url) + sum(len(name) + len(value) for name, value in self.headers)
        self._in_head, self._beside = False, 0
        if self._refused:
            return
        if len(self.headers) > self.bounds.headers or size > self.bounds.header_bytes:
            self._refuse(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE)
        elif len(self.pipeline) >= self.bounds.waiting:
            self._hang_up()
        else:
            self._by(self.bounds.body_within)
            super().on_headers_complete()

    def on_chunk_header(self) -> None:
        """A part of its body begins, or its end."""
        self._beside = 0

    def on_body(self, body: bytes) -> None:
        """A part of its body is here."""
        self._beside = 0
        if not self._refused:
            super().on_body(body)

    def on_message_complete(self) -> None:
        """All of it is here."""
        self._beside = 0
        if not self._refused:
            self._by(None)
            super().on_message_complete()

    def pause_writing(self) -> None:
        """An answer is not read as fast as it is made."""
        super().pause_writing()
        self._be_read(self.transport.get_write_buffer_size())

    def resume_writing(self) -> None:
        """It was read."""
        super().resume_writing()
        if self._reader is not None:
            self._reader.cancel()

    def _be_read(self, unread: int) -> None:
        """Some of the bytes that are left must have been read in a while."""
        self._reader = self.loop.call_later(self.bounds.read_within, self._was_read, unread)

    def _was_read(self, before: int) -> None:
        unread = self.transport.get_write_buffer_size()
        if unread < before:
            self._be_read(unread)
        else:
            self._hang_up()

    def _by(self, seconds: float | None) -> None:
        """Within so many seconds the request must come farther, or there is no such time."""
        self._within, self._moved = seconds, True

    def _set_timer(self) -> None:
        """Count from now, if the deadline is another one."""
        if not self._moved:
            return
        self._moved = False
        if self._deadline is not None:
            self._deadline.cancel()
        self._deadline = None if self._within is None else self.loop.call_later(self._within, self._late)

    def _late(self) -> None:
        if self._in_head:
            self._refuse(HTTPStatus.REQUEST_TIMEOUT)
        else:
            self._hang_up()

    def _refuse(self, status: HTTPStatus) -> None:
        """Answer, and close; amid another answer only close."""
        if self._refused:
            return
        if self.cycle is not None and self.cycle.response_started and not self.cycle.response_complete:
            self._hang_up()
            return
        self._refused = True
        self._by(None)
        head = f"HTTP/1.1 {status.value} {status.phrase}\r\ncontent-length: 0\r\nconnection: close\r\n\r\n"
        if not self.transport.is_closing():
            self.transport.write(head.encode())
            self.transport.close()

    def _hang_up(self) -> None:
        self._refused = True
        self._by(None)
        self.transport.abort()
