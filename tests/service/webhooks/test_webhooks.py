"""A webhook is signed, repeated until it is taken, and sent to no private address."""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import socket
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import httpcore
import pytest

from service.access import KeyStore, Scope
from service.jobs import Database, NewJob, Reached, Registry, Status
from service.jobs.audit import Actor
from service.jobs.held import claim
from service.jobs.job import Webhook
from service.jobs.submission import Submission, Terms, submit_all
from service.webhooks import Notifier, fault_of
from service.webhooks.deliveries import HELD, WAITS, Delivery, settle, take_due
from service.webhooks.public import NotPublic, PublicOnly, is_public
from service.webhooks.sender import send

DELIVERY = Delivery("0" * 26, "http://127.0.0.1:9/", "ab" * 32, "successful", "completed", 0)


class Clock:
    now = 1e9

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def database(tmp_path, tables, clock):
    database = Database(f"sqlite:///{tmp_path}/registry.db", clock)
    yield database
    database.close()


@pytest.fixture
def receiver():
    """A server on loopback that keeps what it gets, and answers as it is told."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            body = self.rfile.read(int(self.headers["Content-Length"]))
            server.got.append((dict(self.headers), body))
            self.send_response(server.status)
            self.send_header("Location", "http://127.0.0.1:1/")
            self.end_headers()

        def log_message(self, *_):
            pass

    server = HTTPServer(("127.0.0.1", 0), Handler)
    server.got, server.status = [], 200
    server.url = f"http://127.0.0.1:{server.server_port}/done"
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield server
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.fixture
def key(database):
    return KeyStore(database).create("alice", frozenset({Scope.SUBMIT}), 3600.0)


@pytest.fixture
def ended(database, key):
    """A job with a webhook, ended."""

    def make(url: str) -> str:
        wanted = Submission(NewJob({}, owner="alice"), Actor("alice", key.prefix), webhook=url)
        with database.writing() as transaction:
            [job] = submit_all(transaction, [wanted], Terms(10))
        held = claim(database, job.id, 9.0, "here")
        held.finish(Status.FAILED, "step_too_small", "soften it", None, Reached())
        return job.id

    return make


def test_its_owner_can_check_the_signature(database, key, ended, receiver):
    job_id = ended(receiver.url)
    [delivery] = take_due(database, 9)
    assert send(delivery, 1234, httpcore.SyncBackend()).again is False
    [(headers, body)] = receiver.got
    told = json.loads(body)
    assert told["data"] == {"id": job_id, "status": "failed", "outcome": "step_too_small", "job": f"/v1/jobs/{job_id}"}
    shared = hashlib.sha256(key.secret.encode()).digest()
    signed = hmac.new(shared, f"{job_id}.1234.".encode() + body, hashlib.sha256).digest()
    assert headers["webhook-signature"] == "v1," + base64.b64encode(signed).decode()
    assert (headers["webhook-id"], headers["webhook-timestamp"]) == (job_id, "1234")


def test_nothing_is_due_before_the_end(database, key):
    wanted = Submission(NewJob({}, owner="alice"), Actor("alice", key.prefix), webhook="http://x/")
    with database.writing() as transaction:
        submit_all(transaction, [wanted], Terms(10))
    assert take_due(database, 9) == []


def test_what_one_takes_no_other_takes_for_a_while(database, ended, clock):
    job_id = ended("http://x.example/")
    assert [one.job_id for one in take_due(database, 9)] == [job_id]
    assert take_due(database, 9) == []
    clock.now += HELD
    assert [one.job_id for one in take_due(database, 9)] == [job_id]


def test_a_try_that_failed_is_repeated_later_and_later_and_then_given_up(database, ended, clock):
    ended("http://x.example/")
    for wait in WAITS:
        [delivery] = take_due(database, 9)
        settle(database, delivery, "answered 500", again=True)
        clock.now += wait - 1
        assert take_due(database, 9) == []
        clock.now += 1
    [last] = take_due(database, 9)
    settle(database, last, "answered 500", again=True)
    clock.now += 1e9
    assert take_due(database, 9) == []


def test_what_became_of_it_stands_in_the_job(database, ended, clock):
    job_id = ended("http://x.example/")
    registry = Registry(database)
    before = registry.get(job_id)
    assert before.webhook == Webhook("http://x.example/", 0, "", 0.0)
    [delivery] = take_due(database, 9)
    settle(database, delivery, "answered 500", again=True)
    after = registry.get(job_id)
    assert after.webhook == Webhook("http://x.example/", 1, "answered 500", clock.now + WAITS[0])
    assert after.version > before.version
    assert registry.page(1).jobs == [after]


@pytest.mark.parametrize("url", [
    "http://localhost/", "http://LOCALHOST./", "http://a.localhost/", "http://127.0.0.1/", "http://0x7f.1/",
    "http://2130706433/", "http://[::1]/", "http://[::ffff:0:127.0.0.1]/", "http://[fe80::1%25eth0]/", "http://10.1/",
    "http://printer/", "http://nas.local/", "http://vault.internal:8200/", "http:///", "http://me:secret@x.example/",
    "http://x.example:99999/", "http://[x/", "http://\0/", "http://x.example/\n", "http://x.example/a b",
])  # fmt: skip
def test_an_address_to_which_nothing_is_sent_is_known_beforehand(url):
    assert fault_of(url)


@pytest.mark.parametrize("url", ["https://lab.example/done", "http://8.8.8.8:8080/", "https://[2606:2800:21f::1]/x"])
def test_an_address_of_the_public_internet_is_taken(url):
    assert fault_of(url) == ""


def test_what_was_taken_is_not_sent_again(database, ended, clock):
    ended("http://x.example/")
    [delivery] = take_due(database, 9)
    settle(database, delivery, "answered 200", again=False)
    clock.now += 1e9
    assert take_due(database, 9) == []


@pytest.mark.parametrize(("status", "again"), [(200, False), (204, False), (302, True), (404, True), (500, True)])
def test_only_2xx_is_a_yes_and_no_redirect_is_followed(receiver, status, again):
    receiver.status = status
    delivery = Delivery(**vars(DELIVERY) | {"url": receiver.url})
    assert send(delivery, 1, httpcore.SyncBackend()).again is again
    assert len(receiver.got) == 1


def test_the_notifier_refuses_a_private_address_for_good_and_never_connects(database, ended, receiver, clock):
    ended(receiver.url)
    Notifier(database).once()
    clock.now += 1e9
    assert take_due(database, 9) == [] and receiver.got == []


@pytest.mark.parametrize("address", [
    "127.0.0.1", "10.0.0.1", "172.16.0.1", "192.168.1.1", "169.254.169.254", "100.64.0.1", "0.0.0.0", "224.0.0.1",
    "255.255.255.255", "::1", "::", "fe80::1", "fe80::1%eth0", "fd00::1", "::ffff:127.0.0.1", "::ffff:10.0.0.1",
    "fec0::2", "::127.0.0.1",
    "::ffff:0:127.0.0.1", "::ffff:0:8.8.8.8", "::8.8.8.8", "64:ff9b:1::7f00:1", "64:ff9b::808:808", "5f00::1",
    "2a00:1450::5efe:a00:1", "2a00:1450::200:5efe:7f00:1", "198.18.0.1", "3fff::1",
    "::10.0.0.1", "64:ff9b::7f00:1", "2002:7f00:1::", "2001:0:4136:e378:8000:63bf:3fff:fdd2", "ff02::1", "192.0.2.1",
])  # fmt: skip
def test_an_address_that_is_not_public_is_told(address):
    assert not is_public(address)


@pytest.mark.parametrize("address", ["93.184.215.14", "2606:2800:21f:cb07:6820:80da:af6b:8b2c", "8.8.8.8"])
def test_a_public_address_is_told(address):
    assert is_public(address)


@pytest.mark.parametrize("found", [["127.0.0.1"], ["93.184.215.14", "10.0.0.1"], ["::1"]])
def test_a_name_that_leads_to_a_private_address_too_is_not_connected_to(monkeypatch, found):
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: [(2, 1, 6, "", (one, 80)) for one in found])
    with pytest.raises(NotPublic):
        PublicOnly().connect_tcp("rebound.example", 80)


def test_the_address_that_was_checked_is_the_one_connected_to(monkeypatch):
    asked, connected = [], []

    def resolve(host, *_, **__):
        asked.append(host)
        return [(2, 1, 6, "", ("93.184.215.14" if len(asked) == 1 else "127.0.0.1", 80))]

    backend = PublicOnly()
    monkeypatch.setattr(socket, "getaddrinfo", resolve)
    monkeypatch.setattr(backend._below, "connect_tcp", lambda host, *_: connected.append(host))
    backend.connect_tcp("rebound.example", 80)
    assert (asked, connected) == (["rebound.example"], ["93.184.215.14"])


@pytest.mark.parametrize("url", ["http://localhost/", "http://[::1]/", "http://0x7f.1/", "http://2130706433/",
                                 "https://127.0.0.1.nip.invalid/", "http:///", "http://\x00/"])  # fmt: skip
def test_no_spelling_of_loopback_gets_through(url):
    told = send(Delivery(**vars(DELIVERY) | {"url": url}), 1).text
    assert not told.startswith("answered")
