"""A connection's bounds: half-sent requests, large heads, and many connections."""

from __future__ import annotations

import asyncio
import http.client
import socket
import threading
import time
from contextlib import closing

import pytest
import uvicorn
from uvicorn.server import Server

from service.api.connections import Bounds, bounded

BOUNDS = Bounds(head_within=0.3, body_within=0.3, header_bytes=4000, headers=20, connections=40, per_address=30)
GET = b"GET / HTTP/1.1\r\nHost: x\r\n"


async def app(scope, receive, send):
    """Answers with the length of the body."""
    if scope["type"] != "http":
        return
    length, more = 0, True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            return
        length, more = length + len(message["body"]), message.get("more_body", False)
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"5")]})
    await send({"type": "http.response.body", "body": b"%5d" % length})


@pytest.fixture(scope="module")
def port():
    listening = socket.create_server(("127.0.0.1", 0))
    config = uvicorn.Config(app, log_config=None, lifespan="off", http=bounded(BOUNDS), ws="none")
    server = Server(config)
    thread = threading.Thread(target=lambda: asyncio.run(server.serve([listening])))
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield listening.getsockname()[1]
    server.should_exit = True
    thread.join(10)
    assert not thread.is_alive()


def connected(port: int) -> socket.socket:
    return socket.create_connection(("127.0.0.1", port), timeout=10)


def answer(port: int, *parts: bytes) -> bytes:
    """All that comes back until the other side closes."""
    with connected(port) as there:
        try:
            for part in parts:
                there.sendall(part)
            return b"".join(iter(lambda: there.recv(4096), b""))
        except (BrokenPipeError, ConnectionResetError):
            return b""


def served(port: int) -> bool:
    return answer(port, GET + b"Connection: close\r\n\r\n").startswith(b"HTTP/1.1 200")


def test_a_whole_request_is_answered_and_a_connection_kept(port):
    with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=10)) as there:
        for body in (b"", b"abc", b"a" * 3000):
            there.request("POST", "/", body)
            mine = there.sock
            assert int(there.getresponse().read()) == len(body)
            assert there.sock is mine


def test_a_request_that_does_not_come_is_not_waited_for(port):
    assert answer(port).startswith(b"HTTP/1.1 408")
    assert answer(port, GET).startswith(b"HTTP/1.1 408")
    assert answer(port, GET + b"Content-Length: 9\r\n\r\n", b"abc") == b""
    assert served(port)


def test_a_head_that_drips_is_not_waited_for_either(port):
    with connected(port) as there:
        there.sendall(GET)
        began, told = time.monotonic(), b""
        there.settimeout(0.05)
        while not told and time.monotonic() < began + 10:
            try:
                there.sendall(b"a: b\r\n")
                told = there.recv(4096)
            except TimeoutError:
                continue
    assert told.startswith(b"HTTP/1.1 4")


@pytest.mark.parametrize("head", [
    b"a: " + b"x" * 5000, b"a: " + b"x" * 1_000_000, b"\r\n".join(b"a%d: b" % i for i in range(30)),
])  # fmt: skip
def test_a_head_that_is_too_large_is_refused(port, head):
    told = answer(port, GET + head, b"\r\n\r\n")
    assert told.startswith(b"HTTP/1.1 431") or told == b""  # it may be closed before all is sent
    assert served(port)


def test_the_line_of_a_request_counts(port):
    assert answer(port, b"GET /" + b"x" * 3999 + b" HTTP/1.1\r\nHost: x\r\n\r\n").startswith(b"HTTP/1.1 431")


def test_more_connections_from_one_address_than_may_be_are_closed_and_make_room_when_they_go(port):
    opened = [connected(port) for _ in range(BOUNDS.per_address + 5)]
    closed = 0
    for there in opened:
        with closing(there):
            try:
                closed += there.recv(100) == b""
            except ConnectionResetError:
                closed += 1
    assert 5 <= closed < len(opened)  # the others were let in, and told that their request is late
    assert served(port)
