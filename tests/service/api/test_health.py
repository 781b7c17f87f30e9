"""/readyz says which part does not get on, and what jobs wait for; /metrics says the same to Prometheus."""

from __future__ import annotations

import sqlite3

import pytest
from sqlalchemy import update

from service.jobs.leader import Leader
from service.jobs.processes import EVERY, FORGOTTEN, SILENT, Presence, Roll, forget_lost
from service.jobs.tables import processes
from service.pulse import LOOK, Listener


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Looks follow each other at once."""
    monkeypatch.setattr("service.api.health.EVERY", 0.01)


@pytest.fixture
def worker(registry):
    """A worker, which has shown once that it is there."""
    presence = Presence(registry.database, "worker")
    presence.beat()
    return presence


def ready(client) -> dict:
    return client.get("/readyz").json()


@pytest.mark.parametrize("path", ["/readyz", "/healthz"])
def test_where_all_parts_do_their_work_it_is_ok(client, worker, until, path):
    until(lambda: client.get(path).json()["status"] == "ok")
    assert client.get(path).json() == {"status": "ok", "database": "ok", "broker": "ok", "disk": "ok", "workers": "ok",
                                       "leader": "ok", "standing_still": []}


def test_without_workers_jobs_can_be_taken_but_it_is_not_ok(client, until):
    until(lambda: ready(client)["broker"] == "ok")
    answer = client.get("/readyz")
    assert (answer.status_code, answer.json()["status"], answer.json()["workers"]) == (200, "degraded", "none")


def test_a_worker_that_beats_no_more_is_told_by_its_name(client, worker, until, monkeypatch):
    until(lambda: ready(client)["workers"] == "ok")
    monkeypatch.setattr("service.jobs.processes.SILENT", 0.0)
    until(lambda: ready(client)["workers"] == "silent")
    told = ready(client)
    assert told["status"] == "degraded"
    assert any(name.startswith("worker ") for name in told["standing_still"])


def test_a_thread_that_does_not_get_on_is_told_and_its_process_shows_no_pulse(client, settings, until, monkeypatch):
    monkeypatch.setattr("service.api.health.BEAT", 0.01)
    [pulse] = settings.pulses.iterdir()
    before = pulse.stat().st_mtime_ns
    monkeypatch.setattr("service.api.health.STUCK", -1.0)
    until(lambda: any("notifier" in name for name in ready(client)["standing_still"]))
    stopped = pulse.stat().st_mtime_ns
    assert ready(client)["status"] == "degraded"
    assert pulse.stat().st_mtime_ns == stopped
    monkeypatch.setattr("service.api.health.STUCK", 60.0)
    until(lambda: pulse.stat().st_mtime_ns > stopped >= before, "it gets on again")


def test_without_its_broker_the_service_is_degraded_but_there(client, until, monkeypatch):
    monkeypatch.setattr("service.jobs.doorbell.Doorbell.reachable", lambda _: False)
    until(lambda: ready(client)["broker"] == "unreachable")
    assert client.get("/readyz").status_code == 200


def test_a_database_that_takes_no_writes_is_told_though_it_can_be_read(client, settings, until):
    until(lambda: ready(client)["database"] == "ok")
    client.app.state.parts.registry.database.engine.dispose()
    with sqlite3.connect(settings.data / "registry.db", isolation_level=None) as other:
        other.execute("CREATE TRIGGER refuse BEFORE UPDATE ON processes BEGIN SELECT RAISE(ABORT, 'refused'); END")
        until(lambda: client.get("/readyz").status_code == 503)
        assert ready(client)["database"] == "unreachable"
        assert client.get("/v1/jobs").status_code == 200
        other.execute("DROP TRIGGER refuse")
    until(lambda: ready(client)["database"] == "ok", "it takes writes again")


def test_a_database_that_never_answers_is_told_at_once_by_who_is_asked(client, until, monkeypatch):
    monkeypatch.setattr("service.api.health.STALE", 0.0)
    answer = client.get("/readyz")
    assert (answer.status_code, answer.json()["database"]) == (503, "unreachable")


@pytest.mark.parametrize("ending", ["", "-wal"])
def test_a_registry_whose_files_vanish_takes_no_jobs_until_they_are_back(client, settings, case, until, ending):
    assert client.get("/readyz").status_code == 200
    path, away = settings.data / f"registry.db{ending}", settings.data / "away"
    path.rename(away)
    ready, refused = client.get("/readyz"), client.post("/v1/jobs", json=case)
    assert (ready.status_code, ready.json()["database"]) == (503, "replaced")
    assert (refused.status_code, refused.headers["Retry-After"]) == (503, "10")
    assert "removed or replaced" in refused.json()["detail"]
    away.rename(path)
    until(lambda: client.get("/readyz").json()["database"] == "ok")
    assert client.post("/v1/jobs", json=case).status_code == 202


def test_without_room_on_its_disk_the_service_is_unavailable(client, monkeypatch):
    monkeypatch.setattr("service.api.health.LEAST_FREE", 10**18)
    answer = client.get("/readyz")
    assert (answer.status_code, answer.json()["status"], answer.json()["disk"]) == (503, "degraded", "full")


def test_without_a_leader_it_is_not_ok(client, worker, until, monkeypatch):
    until(lambda: ready(client)["status"] == "ok")
    monkeypatch.setattr(Leader, "silent", 100.0)
    assert (ready(client)["status"], ready(client)["leader"]) == ("degraded", "none")


def test_the_metrics_tell_of_each_part(client, worker, until, monkeypatch):
    until(lambda: ready(client)["status"] == "ok")
    lines = client.get("/metrics").text.splitlines()
    for part in ("database", "broker", "disk", "workers", "leader"):
        assert f'hockle_part_ok{{part="{part}"}} 1.0' in lines
    assert any(line.startswith('hockle_process_age_seconds{process="worker ') for line in lines)
    monkeypatch.setattr("service.api.health.STALE", 0.0)
    told = client.get("/metrics").text
    assert 'hockle_part_ok{part="database"} 0.0' in told and "hockle_jobs" not in told


def test_silence_is_heard_by_a_clock_that_nobody_sets(registry):
    now = 0.0
    roll = Roll(lambda: Listener(lambda: now))
    presence = Presence(registry.database, "worker")
    for _ in range(10):
        presence.beat()
        now += LOOK
        roll.call(registry.database)
        assert (roll.workers, [name for name in roll.silent if "worker" in name]) == (1, [])
    for _ in range(10):
        now += LOOK
        roll.call(registry.database)
    assert (roll.workers, len([name for name in roll.silent if "worker" in name])) == (0, 1)
    presence.leave()
    roll.call(registry.database)
    assert [name for name in roll.silent if "worker" in name] == []


def test_silence_is_heard_in_time_where_looks_are_slow(registry):
    """As on a busy machine: each look at the processes takes as long as the pause before it."""
    now = 0.0
    roll = Roll(lambda: Listener(lambda: now))
    Presence(registry.database, "worker").beat()
    roll.call(registry.database)
    while now <= SILENT:
        now += 2 * EVERY
        roll.call(registry.database)
    assert [name for name in roll.silent if "worker" in name]


@pytest.fixture
def there(registry):
    """Gives the ids of the workers that have a row."""

    def ids() -> list[str]:
        with registry.database.reading() as connection:
            return [row.id for row in connection.execute(processes.select().where(processes.c.kind == "worker"))]

    return ids


def test_who_comes_takes_along_the_dead_of_its_host(registry, there):
    Presence(registry.database, "worker").beat()
    with registry.database.writing() as transaction:
        workers = update(processes).where(processes.c.kind == "worker")
        transaction.connection.execute(workers.values(id="killed", pid=2**22 + 1))
    presence = Presence(registry.database, "worker")
    presence.beat()
    [mine] = there()
    assert mine != "killed"
    presence.leave()
    assert there() == []


def test_who_is_long_lost_is_forgotten(registry, there):
    Presence(registry.database, "worker").beat()
    forget_lost(registry.database)
    assert len(there()) == 1
    with registry.database.writing() as transaction:
        transaction.connection.execute(update(processes).values(seen=transaction.now - 2 * FORGOTTEN))
    forget_lost(registry.database)
    assert there() == []
