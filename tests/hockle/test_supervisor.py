"""Whatever dies, no job is lost; whatever ends the service, nothing is left running."""

from __future__ import annotations

import signal
import sys
from pathlib import Path

import pytest

from hockle.broker import redis_binary
from hockle.failure import Failure
from hockle.supervisor import Services
from hockle_client import Client, JobState, Problem
from service.settings import Settings

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes through /proc")

API, WORKER, BROKER = "hockle api", "hockle worker", "unixsocket:"
APIS = 2


def running(client, case, until) -> str:
    """The id of a job that a worker has begun."""
    job_id = client.submit(case).id
    until(lambda: client.job(job_id).progress > 0.02, "the job runs")
    return job_id


def end_of(client, job_id) -> JobState:
    return client.job(job_id).wait().state


def test_a_job_goes_the_whole_way_and_its_dataset_is_fetched(server, client, quick, tmp_path):
    done = client.submit(quick).wait()
    assert (done.status, done.state.attempts) == ("successful", 1)
    assert done.fetch(tmp_path / "out.nc") == done.state.dataset.bytes


def test_a_running_job_is_cancelled_and_leaves_nothing(server, client, slow, until, tmp_path):
    job_id = running(client, slow, until)
    done = client.job(job_id).cancel().wait()
    assert (done.status, done.state.dataset) == ("dismissed", None)
    with pytest.raises(Problem, match="dismissed and has no dataset"):
        done.fetch(tmp_path / "out.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_killed_worker_child_costs_only_time(server, client, slow, until):
    job_id = running(client, slow, until)
    child, *_ = server.below(server.service(WORKER))
    server.kill(child)
    done = end_of(client, job_id)
    assert (done.status, done.attempts) == ("successful", 2)


def test_a_killed_worker_is_started_again_and_its_job_ends(server, client, slow, until):
    job_id = running(client, slow, until)
    server.kill(server.service(WORKER))
    done = end_of(client, job_id)
    assert (done.status, done.attempts) == ("successful", 2)


def test_a_killed_api_is_back_at_its_address_and_the_job_ends(server, client, slow, until):
    job_id = running(client, slow, until)
    killed = server.service(API)
    server.kill(killed)
    until(lambda: killed not in server.below(), "the dead is buried")
    with Client(server.address) as again:
        done = end_of(again, job_id)
    assert (done.status, done.attempts) == ("successful", 1)


@pytest.mark.skipif(redis_binary() is None, reason="no Redis on this machine")
def test_jobs_submitted_while_the_broker_is_dead_end(server, client, quick, until):
    server.kill(server.service(BROKER))
    made = [client.submit(quick).id for _ in range(3)]
    assert [end_of(client, job_id).status for job_id in made] == ["successful"] * 3


def test_a_stopped_server_hands_its_job_back_and_the_next_one_ends_it(start, slow, until, is_alive, tmp_path):
    with start(tmp_path) as server, Client(server.address) as client:
        job_id = running(client, slow, until)
        below = server.below()
        server.process.send_signal(signal.SIGINT)
        assert server.process.wait(60) == 0
        assert not any(is_alive(pid) for pid in below)
    assert list((tmp_path / "datasets").iterdir()) == []
    with start(tmp_path) as server, Client(server.address) as client:
        done = end_of(client, job_id)
    assert (done.status, done.attempts) == ("successful", 1)


def test_a_killed_server_takes_all_its_processes_with_it(start, slow, until, is_alive, tmp_path):
    with start(tmp_path) as server, Client(server.address) as client:
        running(client, slow, until)
        below = server.below()
        assert len(below) >= 3  # API, worker and its child, and a broker if there is one
        server.process.kill()
        until(lambda: not any(is_alive(pid) for pid in below), "all have ended")


def test_one_directory_is_served_by_one_server(server):
    data = Path(server.first_line.split("data in ")[1].split(";")[0])
    with pytest.raises(Failure, match="another hockle serves from"), Services(Settings(data), port=0):
        pass


def test_a_taken_port_is_told(server, tmp_path):
    port = int(server.address.rsplit(":", 1)[1])
    with pytest.raises(Failure, match=f"cannot listen on 127.0.0.1 port {port}"), \
            Services(Settings(tmp_path), port=port):  # fmt: skip
        pass


def test_another_host_than_loopback_is_refused(tmp_path):
    everywhere = Services(Settings(tmp_path), "0.0.0.0")
    with pytest.raises(Failure, match="host must be a loopback address"), everywhere:
        pass


def test_without_redis_messages_lie_as_files_and_jobs_end_all_the_same(quick, tmp_path, monkeypatch):
    monkeypatch.setattr("hockle.supervisor.redis_binary", lambda: None)
    with Services(Settings(tmp_path), port=0) as services, Client(services.address) as client:
        assert sorted(services.children) == ["api-1", "api-2", "worker"]
        assert end_of(client, client.submit(quick).id).status == "successful"
