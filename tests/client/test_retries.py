"""What a client does when the server is busy, away or breaks off: a server that answers as it is told."""

from __future__ import annotations

import hashlib
import json
import threading
import time
from collections.abc import Callable, Iterator
from email.utils import formatdate
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import httpx
import pytest

from hockle_client import DamagedDataset, HockleError, Problem, Unreachable
from hockle_client.problems import seconds_of
from hockle_client.retrying import LONGEST, Retries

JOB = {"id": "1", "owner": "local", "status": "successful", "title": "", "label": "", "priority": 0, "progress": 1.0,
       "t": 1.0, "outcome": "completed", "message": "", "cancel_requested": False, "attempts": 1,
       "created": "2026-01-31T12:00:00Z", "started": None, "finished": None, "case_sha256": "",
       "limits": {"wall": 1, "memory": 1, "disk": 1}, "dataset": None, "links": {},
       "said by a newer server": 1}  # fmt: skip
CONTENT = bytes(range(256)) * 1000
ETAG = f'"{hashlib.sha256(CONTENT).hexdigest()}"'

Answer = Callable[[BaseHTTPRequestHandler], None]


class Fake(ThreadingHTTPServer):
    """Gives the answers of a script, one to each request, and keeps what was asked."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.script: list[Answer] = []
        self.asked: list[tuple[str, str, dict[str, str], bytes]] = []
        self.times: list[float] = []

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: Fake

    def _answer(self) -> None:
        body = self.rfile.read(int(self.headers.get("content-length", 0)))
        self.server.asked.append((self.command, self.path, {k.lower(): v for k, v in self.headers.items()}, body))
        self.server.times.append(time.monotonic())
        self.server.script.pop(0)(self)

    do_GET = do_POST = do_DELETE = _answer

    def log_message(self, *_: Any) -> None:
        pass


def says(status: int, document: Any = None, **headers: str) -> Answer:
    def answer(handler: BaseHTTPRequestHandler) -> None:
        body = json.dumps(document if document is not None else {"type": "about:blank", "detail": "no"}).encode()
        handler.send_response(status)
        kind = "application/json" if status < 400 else "application/problem+json"
        for name, value in {"Content-Type": kind, "Content-Length": str(len(body)), **headers}.items():
            handler.send_header(name.replace("_", "-"), value)
        handler.end_headers()
        handler.wfile.write(body)

    return answer


def hangs_up(handler: BaseHTTPRequestHandler) -> None:
    handler.close_connection = True


def sends(content: bytes, start: int = 0, stop: int | None = None, etag: str = ETAG, status: int = 200) -> Answer:
    """Bytes of a file from `start` on; breaks off before `stop` if it is less than their number."""

    def answer(handler: BaseHTTPRequestHandler) -> None:
        handler.send_response(status)
        handler.send_header("ETag", etag)
        handler.send_header("Content-Length", str(len(content) - start))
        handler.end_headers()
        handler.wfile.write(content[start:stop])
        handler.close_connection = True

    return answer


def streams(*lines: str) -> Answer:
    def answer(handler: BaseHTTPRequestHandler) -> None:
        handler.send_response(200)
        handler.send_header("Content-Type", "text/event-stream")
        handler.send_header("Connection", "close")
        handler.end_headers()
        handler.wfile.write("".join(lines).encode())
        handler.close_connection = True

    return answer


@pytest.fixture
def fake() -> Iterator[Fake]:
    server = Fake()
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield server
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.fixture
def client(connect, fake: Fake) -> Any:
    return connect(fake.address, "hk_key", patience=20.0)


@pytest.mark.parametrize("first", [says(429), says(502), says(503), says(504), hangs_up,
                                   says(409, {"type": "urn:hockle:problem:in_flight"}, Retry_After="0")],
                         ids=["429", "502", "503", "504", "hangs up", "in flight"])  # fmt: skip
def test_a_submission_is_sent_again_with_the_same_key(client, fake, first):
    fake.script = [first, first, says(202, JOB)]
    assert client.submit("elastica", set={"t_end": 1}, limits={"wall": 60}).id == "1"
    assert len({(method, path, headers["idempotency-key"], body) for method, path, headers, body in fake.asked}) == 1
    _, _, headers, body = fake.asked[0]
    assert headers["authorization"] == "Bearer hk_key" and headers["content-type"] == "application/json"
    assert json.loads(body) == {"case": "elastica", "set": {"t_end": 1}, "label": "", "priority": 0, "reuse": True,
                                "limits": {"wall": 60}}  # fmt: skip


def test_each_submission_has_a_key_of_its_own(client, fake):
    fake.script = [says(202, JOB)] * 2
    client.submit("elastica"), client.submit("elastica")
    assert len({headers["idempotency-key"] for _, _, headers, _ in fake.asked}) == 2


@pytest.mark.parametrize("after", ["1", "date"])
def test_it_comes_again_when_the_server_says(client, fake, after):
    told = formatdate(time.time() + 2, usegmt=True) if after == "date" else after
    fake.script = [says(429, Retry_After=told), says(200, JOB)]
    assert client.job("1").status == "successful"
    assert fake.times[1] - fake.times[0] >= 0.9


def test_what_will_not_be_better_is_told_at_once(client, fake):
    fake.script = [says(422, {"type": "urn:hockle:problem:invalid_case", "errors": []}), says(500), says(404)]
    for status in (422, 500, 404):
        with pytest.raises(Problem) as refused:
            client.job("1")
        assert refused.value.status == status
    assert len(fake.asked) == 3


def test_patience_has_an_end(connect, fake):
    client = connect(fake.address, patience=0.5)
    fake.script = [says(503)] * 100
    with pytest.raises(Problem) as refused:
        client.job("1")
    assert (refused.value.status, refused.value.temporary) == (503, True)
    assert 2 <= len(fake.asked) <= 20
    fake.script, many = [says(429, Retry_After="3600")], len(fake.asked)
    with pytest.raises(Problem) as refused:
        client.job("1")
    assert refused.value.retry_after == 3600 and len(fake.asked) == many + 1


@pytest.mark.parametrize("url", ["ftp://127.0.0.1", "127.0.0.1:8000"])
def test_an_address_that_is_none_is_not_tried_again(connect, url):
    with pytest.raises(HockleError, match="no hockle server answers"):
        connect(url).job("1")


def test_nobody_there_is_told(connect):
    with pytest.raises(Unreachable, match=r"no hockle server answers at http://127\.0\.0\.1:9"):
        connect("http://127.0.0.1:9", patience=0.3).job("1")


def test_what_is_no_problem_document_is_told_too(client, fake):
    fake.script = [says(418, "teapot", Content_Type="text/plain")]
    with pytest.raises(Problem, match="the server answered 418") as refused:
        client.job("1")
    assert refused.value.type == "about:blank"


def test_a_download_goes_on_where_it_broke_off(client, fake, tmp_path):
    fake.script = [says(200, JOB), sends(CONTENT, 0, 100_000), sends(CONTENT, 100_000, 150_000, status=206),
                   says(503), sends(CONTENT, 150_000, status=206)]  # fmt: skip
    assert client.job("1").fetch(tmp_path / "x.nc") == len(CONTENT)
    assert (tmp_path / "x.nc").read_bytes() == CONTENT
    asked = [(headers.get("range"), headers.get("if-range")) for _, _, headers, _ in fake.asked[1:]]
    assert asked == [(None, None), ("bytes=100000-", ETAG), ("bytes=150000-", ETAG), ("bytes=150000-", ETAG)]


def test_a_download_of_what_has_changed_begins_anew(client, fake, tmp_path):
    other = CONTENT[::-1]
    etag = f'"{hashlib.sha256(other).hexdigest()}"'
    fake.script = [says(200, JOB), sends(CONTENT, 0, 1000), sends(other, etag=etag)]
    client.job("1").fetch(tmp_path / "x.nc")
    assert (tmp_path / "x.nc").read_bytes() == other


def test_a_damaged_download_is_tried_again_and_never_kept(connect, fake, tmp_path):
    client = connect(fake.address, patience=0.2)
    fake.script = [says(200, JOB), *[sends(CONTENT, etag='"other"')] * 20]
    with pytest.raises(DamagedDataset, match="sha256"):
        client.job("1").fetch(tmp_path / "x.nc")
    assert list(tmp_path.iterdir()) == [] and len(fake.asked) > 2


def event(number: int, kind: str) -> str:
    return f'id: {number}\nevent: {kind}\ndata: {{"n": {number}}}\n\n'


def test_events_go_on_after_a_break_from_where_they_were(client, fake):
    fake.script = [says(200, JOB), streams(event(1, "accepted"), ": still here\n\n", event(2, "started"), "id: 3\nev"),
                   says(503), streams(event(3, "progress")), streams(event(4, "ended")), says(204)]  # fmt: skip
    told = list(client.job("1").events())
    assert [(one.id, one.kind, one.data) for one in told] == [
        (1, "accepted", {"n": 1}), (2, "started", {"n": 2}), (3, "progress", {"n": 3}), (4, "ended", {"n": 4})]
    assert [headers["last-event-id"] for _, _, headers, _ in fake.asked[1:]] == ["0", "2", "2", "3", "4"]


def test_tries_come_slower_and_slower():
    retries = Retries(patience=1e9)
    waits = [retries.after(Unreachable("x", httpx.ConnectError("no"))) for _ in range(10)]
    assert waits[0] <= 0.1 and waits[-1] <= LONGEST and waits[-1] >= LONGEST / 2


@pytest.mark.parametrize(("told", "seconds"), [(None, None), ("5", 5.0), ("soon", None),
                                               ("Wed, 21 Oct 2015 07:28:00 GMT", 0.0)])  # fmt: skip
def test_retry_after_is_seconds_or_a_date(told, seconds):
    assert seconds_of(told) == seconds
