"""HTTP/1.1 over one keep-alive connection, with so little work a request that a thousand clients fit on a core.

It understands what our own server sends (Content-Length, or a stream without end), and nothing more.
"""

from __future__ import annotations

import asyncio
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

LENGTH = re.compile(rb"content-length: (\d+)", re.IGNORECASE)
TAG = re.compile(rb"etag: (\S+)", re.IGNORECASE)


@dataclass(frozen=True)
class Answer:
    """Status, ETag and body, and how long it took (s)."""

    status: int
    etag: str
    body: bytes
    seconds: float


class Connection(asyncio.Protocol):
    """One client; it asks one thing at a time."""

    def __init__(self, host: str, port: int) -> None:
        self._where = f"{host}:{port}"
        self._received = b""
        self._waiting: asyncio.Future[Answer] | None = None
        self._transport: asyncio.Transport
        self._sent = 0.0
        self.on_line: Callable[[bytes, float], None] | None = None

    @classmethod
    async def open(cls, host: str, port: int) -> Connection:
        """Connect."""
        _, connection = await asyncio.get_running_loop().create_connection(lambda: cls(host, port), host, port)
        return connection

    def close(self) -> None:
        """Hang up."""
        self._transport.close()

    def text(self, method: str, path: str, body: bytes = b"", **headers: str) -> bytes:
        """A request as it goes over the wire, so that it can be made once and sent often."""
        lines = [f"{method} {path} HTTP/1.1", f"Host: {self._where}"]
        lines += [f"{name.replace('_', '-')}: {value}" for name, value in headers.items()]
        if body:
            lines += ["Content-Type: application/json", f"Content-Length: {len(body)}"]
        return "\r\n".join([*lines, "", ""]).encode() + body

    def ask(self, text: bytes) -> asyncio.Future[Answer]:
        """Send a request; the future is its answer."""
        self._waiting = asyncio.get_running_loop().create_future()
        self._sent = time.perf_counter()
        self._transport.write(text)
        return self._waiting

    def stream(self, text: bytes, on_line: Callable[[bytes, float], None]) -> None:
        """Send a request whose answer does not end; `on_line` gets each line and the time (Unix seconds)."""
        self.on_line = on_line
        self._transport.write(text)

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Remember where to write."""
        self._transport = cast(asyncio.Transport, transport)

    def connection_lost(self, error: Exception | None) -> None:
        """Whoever waits is told."""
        if self._waiting is not None and not self._waiting.done():
            self._waiting.set_exception(ConnectionResetError("the server hung up"))

    def data_received(self, data: bytes) -> None:
        """Collect until the answer is whole."""
        self._received += data
        if self.on_line is not None:
            *lines, self._received = self._received.split(b"\n")
            for line in lines:
                self.on_line(line, time.time())
            return
        head, end, body = self._received.partition(b"\r\n\r\n")
        length = LENGTH.search(head)
        if not end or len(body) < (int(length[1]) if length else 0) or self._waiting is None:
            return
        tag = TAG.search(head)
        self._received = b""
        waiting, self._waiting = self._waiting, None
        waiting.set_result(Answer(int(head[9:12]), tag[1].decode() if tag else "", body,
                                  time.perf_counter() - self._sent))
