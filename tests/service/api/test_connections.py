"""A connection's bounds: half-sent requests, large heads, and many connections."""

from __future__ import annotations

import http.client
import resource
import socket
import threading
import time
from contextlib import closing, suppress

import pytest
import uvicorn
from uvicorn.server import Server

from service.api.connections import KEPT_BACK, Bounds, bounded, bounds_here

BOUNDS = Bounds(head_within=0.3, body_within=0.3, read_within=0.3, header_bytes=4000, headers=20, waiting=5,
                connections=40, per_address=30)  # fmt: skip
GET = b"GET / HTTP/1.1\r\nHost: x\r\n"


CHUNKED = b"POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
LARGE = 30_000_000
"""Bytes of an answer: more than the buffers on its way hold."""
asked: list[dict] = []
"""The requests that the app has had."""


async def app(scope, receive, send):
    """Answers with the length of the body; at /large with much, until nobody is there."""
    if scope["type"] != "http":
        return
    asked.append(scope)
    length, more = 0, True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            return
        length, more = length + len(message["body"]), message.get("more_body", False)
    if scope["path"] == "/large":
        await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"%d" % LARGE)]})
        for _ in range(LARGE // 1_000_000):
            await send({"type": "http.response.body", "body": b"x" * 1_000_000, "more_body": True})
        await send({"type": "http.response.body", "body": b""})
        asked.remove(scope)
        return
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"5")]})
    await send({"type": "http.response.body", "body": b"%5d" % length})


@pytest.fixture(scope="module")
def port():
    listening = socket.create_server(("127.0.0.1", 0))
    config = uvicorn.Config(app, log_config=None, lifespan="off", http=bounded(BOUNDS), ws="none")
    server = Server(config)
    thread = threading.Thread(target=server.run, args=([listening],))
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


def test_who_has_been_answered_is_not_kept_by_empty_lines(port):
    with connected(port) as there:
        there.sendall(GET + b"\r\n")
        assert there.recv(4096)
        began = time.monotonic()
        with suppress(OSError):
            while there.send(b"\r\n") and time.monotonic() < began + 3:
                time.sleep(0.05)
        assert time.monotonic() < began + 3


def test_requests_that_are_sent_without_waiting_for_answers_are_bounded(port):
    asked.clear()
    assert answer(port, GET + b"\r\n" + GET + b"Connection: close\r\n\r\n").count(b"HTTP/1.1 200") == 2
    answer(port, (GET + b"\r\n") * 5000)
    assert len(asked) <= 2 + BOUNDS.waiting + 2
    assert served(port)


def test_what_follows_a_body_is_no_header_and_is_bounded(port):
    asked.clear()
    told = answer(port, CHUNKED + b"3\r\nabc\r\n0\r\nX-Late: 1\r\n\r\n" + GET + b"Connection: close\r\n\r\n")
    assert told.count(b"HTTP/1.1 200") == 2
    assert b"x-late" not in dict(asked[0]["headers"])
    for late in (b"X: " + b"y" * 1_000_000, b"X: y\r\n" * 100_000):
        asked.clear()
        assert b"200" not in answer(port, CHUNKED + b"0\r\n", late, b"\r\n\r\n")
        assert len(asked[0]["headers"]) == 2
    assert b"200" not in answer(port, CHUNKED + b"3;" + b"x" * 1_000_000, b"\r\nabc\r\n0\r\n\r\n")
    assert served(port)


def test_a_body_of_many_small_chunks_is_read(port):
    told = answer(port, CHUNKED, *([b"1\r\nx\r\n" * 500] * 20), b"0\r\n\r\n" + GET + b"Connection: close\r\n\r\n")
    assert b"10000" in told


def test_who_does_not_read_the_answer_is_hung_up_on(port, until):
    asked.clear()
    with connected(port) as there:
        there.sendall(GET.replace(b"/ ", b"/large ") + b"\r\n")
        until(lambda: asked, "it is being answered")
        until(lambda: not asked, "the answer is given up")


def test_who_reads_slowly_gets_all_of_it(port):
    with connected(port) as there:
        there.sendall(GET.replace(b"/ ", b"/large ") + b"Connection: close\r\n\r\n")
        got = 0
        while part := there.recv(1_000_000):
            got += len(part)
            time.sleep(0.02)
    assert got > LARGE


@pytest.mark.parametrize("hard", [resource.RLIM_INFINITY, 524_288, 4096, 1024, 256])
def test_each_connection_may_have_a_file_open_beside_it_and_some_descriptors_are_kept_back(monkeypatch, hard):
    kept = []
    monkeypatch.setattr("resource.getrlimit", lambda _: (min(1024, hard) if hard > 0 else 1024, hard))
    monkeypatch.setattr("resource.setrlimit", lambda _, limits: kept.append(limits[0]))
    bounds = bounds_here()
    [soft] = kept
    assert soft <= hard or hard == resource.RLIM_INFINITY
    assert 2 * bounds.connections <= soft - min(KEPT_BACK, soft // 2)
    assert 1 <= bounds.per_address <= bounds.connections / 2
