"""Single requests that are too large or too odd: each is refused soon, and others are answered meanwhile."""

from __future__ import annotations

import json
import socket
import threading
import time
from contextlib import suppress

import httpx

from chaos.attack.table import Row

SOON = 15.0
"""Seconds within which each is answered or hung up on."""
MEANWHILE = 0.5
"""Seconds that nobody else may wait."""
MB = 1_000_000
HEAD = b"GET /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\n"


def _posted(body: bytes) -> bytes:
    head = f"POST /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\nContent-Length: {len(body)}"
    return head.encode() + b"\r\n\r\n" + body


def _chunked(rest: bytes) -> bytes:
    return _posted(b"").replace(b"Content-Length: 0", b"Transfer-Encoding: chunked") + rest


def _doubled(many: int) -> bytes:
    keys = [f'"{number:x}":0' for number in range(many)]
    return ("{" + ",".join([*keys, keys[-1]]) + "}").encode()


def _odd() -> dict[str, tuple[bytes, tuple[int, ...]]]:
    """What is sent, and which answers are right; together half a gigabyte, which is gone afterwards."""
    return {
        "a header of 100 MB": (HEAD + b"X-Large: " + b"x" * (100 * MB) + b"\r\n\r\n", (431,)),
        "10,000 headers": (HEAD + b"".join(b"X-%d: y\r\n" % number for number in range(10_000)) + b"\r\n", (431,)),
        "an address of 1 MB": (b"GET /" + b"x" * MB + b" HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", (431,)),
        "two Host headers": (HEAD + b"Host: other.example\r\n\r\n", (400,)),
        "no Host header": (b"GET /v1/jobs HTTP/1.1\r\n\r\n", (400, 421)),
        "two lengths of a body": (_posted(b"{}").replace(b"\r\n\r\n", b"\r\nContent-Length: 7\r\n\r\n", 1), (400,)),
        "a length and chunks": (_posted(b"{}").replace(b"\r\n\r\n", b"\r\nTransfer-Encoding: chunked\r\n\r\n", 1),
                                (400,)),
        "a trailer of 100 MB": (_chunked(b"0\r\nX-Large: " + b"x" * (100 * MB)), (431,)),
        "a trailer of 1,000,000 lines": (_chunked(b"0\r\n" + b"X: y\r\n" * MB), (431,)),
        "a chunk with a head of 100 MB": (_chunked(b"2;" + b"x" * (100 * MB)), (431,)),
        "100,000 requests on one connection, no answer awaited": ((HEAD + b"\r\n") * 100_000, (200,)),
        "no HTTP at all": (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" * 50, (400,)),
        "a body of 830 kB with its last key doubled": (_posted(_doubled(80_000)), (400,)),
        "a body nested 100,000 deep": (_posted(b"[" * 100_000), (400,)),
        "a number of 900,000 digits": (_posted(b'{"t_end":' + b"9" * 900_000 + b"}"), (400,)),
        "90,000 unknown fields": (
            _posted(json.dumps({"case": [{f"f{n}": 0} for n in range(90_000)]})[:999_000].encode()), (400, 422)),
        "a body of 200 MB": (_posted(b" " * (200 * MB)), (413,)),
    }  # fmt: skip


def odd_requests(port: int) -> list[Row]:
    """Send each, and see who else waits for how long meanwhile."""
    return [_row(port, name, request, right) for name, (request, right) in _odd().items()]


def _row(port: int, name: str, request: bytes, right: tuple[int, ...]) -> Row:
    over, longest = threading.Event(), [0.0]
    bystander = threading.Thread(target=_ask_on, args=(port, over, longest))
    bystander.start()
    began = time.perf_counter()
    status = _status_of(port, request)
    took = time.perf_counter() - began
    over.set()
    bystander.join()
    answer = str(status) if status else "hung up"
    good = (status in right or status == 0) and took <= SOON and longest[0] <= MEANWHILE
    return Row(name, f"{answer} after {took:.2f} s, others wait {longest[0] * 1e3:.0f} ms",
               f"{' or '.join(map(str, right))}, or hung up on; others <= {MEANWHILE * 1e3:.0f} ms", good)  # fmt: skip


def _status_of(port: int, request: bytes) -> int:
    """The status of the answer, 0 for none. An answer may come before all is sent."""
    with socket.create_connection(("127.0.0.1", port), timeout=SOON) as connection:
        with suppress(OSError):
            connection.sendall(request)
        with suppress(OSError):
            answer = connection.recv(64)
            if answer.startswith(b"HTTP/1.1 "):
                return int(answer[9:12])
    return 0


def _ask_on(port: int, over: threading.Event, longest: list[float]) -> None:
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60.0, trust_env=False) as client:
        while True:
            began = time.perf_counter()
            with suppress(httpx.TransportError):
                client.get("/livez")
            longest[0] = max(longest[0], time.perf_counter() - began)
            if over.wait(0.02):
                return
