"""A client that waits outlives the server that it waits for."""

from __future__ import annotations

import threading

import pytest

from chaos.campaign import free_port
from hockle_client import Client, Unreachable
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


@pytest.mark.parametrize("how", ["waits", "reads events"])
def test_a_server_is_stopped_and_started_under_a_waiting_client(connect, slow, tmp_path, until, how):
    port, slow = free_port(), slow.set("t_end", 2.0)
    with serving(tmp_path, port=port) as server:
        client = connect(server.address)
        job = client.submit(slow)
        until(lambda: client.job(job.id).progress > 0.02, "the job runs")
        waiting = Waiting(job.wait if how == "waits" else lambda: list(job.events()))
    with serving(tmp_path, port=port) as server:
        assert server.address
        told = waiting.result()
        if how == "waits":
            assert (told.status, told.id) == ("successful", job.id)
        else:
            ids = [event.id for event in told]
            assert ids == sorted(set(ids)) and told[-1].kind == "ended"
        assert job.fetch(tmp_path / "out.nc") == job.refresh().state.dataset.bytes
    getattr(client, "inner", client).patience = 0.5
    with pytest.raises(Unreachable, match=f"no hockle server answers at http://127.0.0.1:{port}"):
        job.refresh()


def test_submissions_go_on_while_the_interface_is_killed_and_none_is_made_twice(connect, quick, tmp_path, until):
    with serving(tmp_path) as server, Client(server.address) as looking:
        assert server.address
        client, stop = connect(server.address), threading.Event()

        def submit():
            made = []
            while not stop.is_set():
                made.append(client.submit(quick.set("t_end", 0.2 + 0.001 * len(made)), again=True).id)
            return made

        submitting = Waiting(submit)
        until(lambda: submitting.error or len(list(looking.jobs())) > 5, "jobs are made")
        server.kill(server.service("hockle api"))
        until(lambda: server.ready, "the interface is back")
        stop.wait(1.0)
        stop.set()
        made = submitting.result()
        listed = [job.id for job in looking.jobs()]
        assert len(made) == len(set(made)) and sorted(listed) == sorted(made)
