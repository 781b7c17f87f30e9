"""An operator pauses, drains and resumes what really runs, and queues failed jobs again."""

from __future__ import annotations

import platform

import pytest

from hockle.cli import main

HERE = platform.node()


@pytest.fixture(autouse=True)
def _server(server, client, until, monkeypatch):
    monkeypatch.setenv("HOCKLE_SERVER", server.address)
    until(lambda: client.workforce().hosts, "the worker is there")
    yield
    client.resume()
    client.resume(HERE)


def test_a_drained_host_hands_its_job_back_and_goes_on_with_it_later(client, slow, until, capsys):
    job = client.submit(slow)
    until(lambda: client.job(job.id).progress > 0.02, "the job runs")
    assert main(["pause", "--host", HERE, "--drain"]) == 0
    assert f"{HERE}: 1 workers, drained by local" in capsys.readouterr().out
    until(lambda: client.job(job.id).status == "accepted", "it is handed back")
    reached = client.job(job.id).progress
    assert main(["resume", "--host", HERE]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == f"{HERE}: 1 workers"
    done = job.wait()
    assert (done.status, done.state.attempts) == ("successful", 1)
    assert reached > 0.02


def test_a_paused_queue_runs_nothing_until_it_is_resumed(client, quick, capsys):
    assert main(["pause"]) == 0
    job = client.submit(quick)
    assert main(["queue"]) == 0
    assert "queue: 1 waiting, 0 running, paused by local" in capsys.readouterr().out
    assert main(["resume"]) == 0
    assert job.wait().status == "successful"


def test_a_failed_job_is_run_again(client, slow, capsys):
    failed = client.submit(slow, limits={"wall": 0.1}).wait()
    assert failed.status == "failed"
    assert main(["requeue", failed.id]) == 0
    again = client.job(capsys.readouterr().out.partition(":")[0])
    assert again.id != failed.id and again.wait().state.case_sha256 == failed.state.case_sha256


def test_a_host_that_is_not_there_is_told(capsys):
    assert main(["pause", "--host", "nowhere"]) == 1
    assert "no worker is on 'nowhere'" in capsys.readouterr().err
