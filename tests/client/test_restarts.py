"""A client that waits outlives the server that it waits for."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from typing import Any

import pytest

from chaos.campaign import free_port
from hockle_client import Client, Unreachable
from tests.client.conftest import KINDS, connecting
from tests.hockle.conftest import serving


class Waiting(threading.Thread):
    """Something that waits for the server, and what came of it."""

    def __init__(self, what):
        super().__init__(daemon=True)
        self.what, self.told, self.error = what, None, None
        self.start()

    def run(self):
        try:
            self.told = self.what()
        except Exception as error:
            self.error = error

    def result(self):
        self.join(120.0)
        assert not self.is_alive(), "it waits still"
        if self.error:
            raise self.error
        return self.told


WAYS = {"waits": lambda job: job.wait(), "reads events": lambda job: list(job.events())}


@pytest.fixture
def client_of() -> Iterator[Callable[[str, str], Any]]:
    """`client_of(kind, url)` is a client of that kind, which one thread may have for itself."""
    with ExitStack() as opened:
        yield lambda kind, url: opened.enter_context(connecting(kind))(url)


def test_a_server_is_stopped_and_started_under_waiting_clients(client_of, slow, tmp_path, until):
    port, slow = free_port(), slow.set("t_end", 2.0)
    with serving(tmp_path, port=port) as server, Client(server.address) as looking:
        job_id = looking.submit(slow).id
        until(lambda: looking.job(job_id).progress > 0.02, "the job runs")
        clients = {(kind, way): client_of(kind, server.address) for kind in KINDS for way in WAYS}
        jobs = {which: client.job(job_id) for which, client in clients.items()}
        waiting = {(kind, way): Waiting(partial(WAYS[way], job)) for (kind, way), job in jobs.items()}
    with serving(tmp_path, port=port) as server:
        assert server.address
        for (kind, way), job in jobs.items():
            told = waiting[kind, way].result()
            if way == "waits":
                assert (told.status, told.id) == ("successful", job_id)
            else:
                ids = [event.id for event in told]
                assert ids == sorted(set(ids)) and told[-1].kind == "ended"
            assert job.fetch(tmp_path / "out.nc") == job.refresh().state.dataset.bytes
    for which, client in clients.items():
        getattr(client, "inner", client).patience = 0.5
        with pytest.raises(Unreachable, match=f"no hockle server answers at http://127.0.0.1:{port}"):
            jobs[which].refresh()


def test_submissions_go_on_while_the_interface_is_killed_and_none_is_made_twice(client_of, quick, tmp_path, until):
    with serving(tmp_path, apis=2) as server, Client(server.address) as looking:
        assert server.address
        stop = threading.Event()

        def submit(client):
            made = []
            while not stop.is_set():
                made.append(client.submit(quick.set("t_end", 0.2 + 0.001 * len(made)), again=True).id)
            return made

        submitting = [Waiting(partial(submit, client_of(kind, server.address))) for kind in KINDS]

        def more_are_made():
            many = len(list(looking.jobs()))
            until(lambda: any(one.error for one in submitting) or len(list(looking.jobs())) > many + 5, "jobs are made")

        more_are_made()
        server.kill(server.service("hockle api"))
        until(lambda: server.ready, "the interface is back")
        more_are_made()
        stop.set()
        made = [job_id for one in submitting for job_id in one.result()]
        listed = [job.id for job in looking.jobs()]
        assert len(made) == len(set(made)) and sorted(listed) == sorted(made)
