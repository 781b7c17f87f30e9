"""What is stopped is there, but gets on no more: it is told, ended and started again, and no job is lost."""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

import httpx
import pytest

from hockle_client import Client

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes through /proc")

API, WORKER, BROKER = "hockle api", "hockle worker", "unixsocket:"
APIS = 2


def readiness(server) -> dict:
    with suppress(httpx.TransportError):
        return httpx.get(f"{server.address}/readyz", timeout=2.0, trust_env=False).json()
    return {}


class Silence:
    """The kinds of processes that were ever said to stand still: one may be replaced before the next falls silent."""

    def __init__(self, server) -> None:
        self._server, self._kinds = server, set()

    def heard_of(self, *kinds: str) -> bool:
        """Whether they were, or whether one of them was stopped while it wrote, so that no other process can."""
        state = readiness(self._server)
        self._kinds |= {name.split()[0] for name in state.get("standing_still", ())}
        return self._kinds.issuperset(kinds) or state.get("database") == "unreachable"


def test_a_stopped_api_process_worker_and_broker_are_replaced_and_their_job_ends(server, slow, until):
    with Client(server.address, patience=120.0) as client:
        until(lambda: readiness(server).get("status") == "ok", "all parts are there")
        job = client.submit(slow)
        until(lambda: client.job(job.id).progress > 0.02, "the job runs")
        stopped = {words: server.service(words) for words in (API, WORKER, BROKER)}
        for pid in stopped.values():
            os.kill(pid, signal.SIGSTOP)
        silence = Silence(server)
        until(lambda: silence.heard_of("api", "worker"), "they are said to be silent")
        until(lambda: not set(stopped.values()) & set(server.below()), "they are replaced")
        until(lambda: readiness(server).get("status") == "ok", "all parts are there again")
        assert client.job(job.id).wait().status == "successful"


def test_a_stopped_child_of_the_pool_is_replaced_and_its_job_ends(server, slow, until):
    with Client(server.address, patience=120.0) as client:
        job = client.submit(slow)
        until(lambda: client.job(job.id).progress > 0.02, "the job runs")
        child, *_ = server.below(server.service(WORKER))
        os.kill(child, signal.SIGSTOP)
        until(lambda: child not in server.below(), "it is replaced")
        done = client.job(job.id).wait()
        assert (done.status, done.state.attempts) == ("successful", 2)
