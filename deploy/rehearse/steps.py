"""What the rehearsal does, in its order. Each step waits for what should come, and says what it saw."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from time import monotonic
from typing import Any

import httpx

from deploy.rehearse.container import Container
from deploy.rehearse.stage import Stage
from hockle_client import Client, Job

QUICK = {"t_end": 0.5, "output.interval": 0.1, "numerics.intervals": 20}
SLOW = {"t_end": 8.0, "output.interval": 0.1, "numerics.dt_max": 0.0005}
MANY = 12
LOOK = "grep -E '^(CapEff|CapBnd|NoNewPrivs|Uid)' /proc/self/status | tr -s '\\t\\n' '  '"


def databases(stage: Stage) -> str:
    """Redis and PostgreSQL start and are healthy."""
    for one in (stage.redis, stage.postgres):
        one.start()
        stage.wait(one.healthy, f"the health check of {one.service.name} passes")
    return "both health checks pass"


def refused_without_a_key(stage: Stage) -> str:
    """The API, on all addresses and with no key made, refuses to start."""
    ended = stage.api.run(*stage.api.service.command)
    expect(ended.returncode == 1 and "no API key" in ended.stderr, ended.stderr)
    return ended.stderr.strip()


def key(stage: Stage) -> str:
    """A key is made as the README says (`docker compose run`)."""
    ended = stage.api.run("hockle", "keys", "create", "rehearsal")
    expect(ended.returncode == 0, ended.stderr)
    stage.key = ended.stdout.strip()
    return f"a key of {len(stage.key)} characters"


def api(stage: Stage) -> str:
    """The API starts and its health check passes; who has no key is refused."""
    began = monotonic()
    stage.api.start()
    stage.wait(stage.api.healthy, "the health check of the API passes")
    took = monotonic() - began
    status = httpx.get(f"http://{stage.network.addresses['api']}:8000/v1/jobs").status_code
    expect(status == 401, status)
    return f"healthy after {took:.0f} s; without a key 401"


def rights(stage: Stage) -> str:
    """A container's user, rights and files are what the image and the compose file say."""
    told = stage.api.run("sh", "-c", LOOK).stdout.strip()
    expect(told.startswith("Uid: 10001 10001 10001 10001 CapEff: 0000000000000000 CapBnd: 0000000000000000 "), told)
    expect(told.endswith("NoNewPrivs: 1"), told)
    refused = stage.api.run("touch", "/opt/hockle/x", "/kernels/x", "/x").stderr
    expect(refused.count("Read-only file system") == 3, refused)
    expect(stage.api.run("touch", "/data/x", "/store/x", "/tmp/x").returncode == 0, "volumes cannot be written")
    return f"`{told}`; its files are read-only but for /data, /store and /tmp"


def workers(stage: Stage) -> str:
    """Two workers start, and a first job ends with the kernels of the image."""
    began = monotonic()
    for worker in stage.workers:
        worker.start()
    with stage.client() as client:
        job = ended(submit(client, QUICK))
    expect(not (stage.volumes["data"] / "kernels").exists(), "kernels were compiled into the volume")
    return f"{job.status} {monotonic() - began:.0f} s after the start; nothing was compiled"


def spread(stage: Stage) -> str:
    """Many jobs end, and both workers had some."""
    with stage.client() as client:
        jobs = [submit(client, QUICK) for _ in range(MANY)]
        statuses = {ended(job).status for job in jobs}
    shares = [sum(job.id in log_of(worker) for job in jobs) for worker in stage.workers]
    expect(statuses == {"successful"} and min(shares) > 0, (statuses, shares))
    return f"{MANY} successful, {shares[0]} by the one and {shares[1]} by the other"


def killed(stage: Stage) -> str:
    """A worker's host dies with its job: the other takes it over from its checkpoint."""
    with stage.client() as client:
        job, worker = running(stage, client)
        worker.kill()
        seen = taken_over(job)
    worker.start()
    return seen


def cut_off(stage: Stage) -> str:
    """A worker's host loses the network: it ends its job itself, the other takes it over, and it comes back."""
    with stage.client() as client:
        job, worker = running(stage, client)
        stage.network.cut(worker.host, off=True)
        seen = taken_over(job)
        stage.network.cut(worker.host, off=False)
        stage.wait(lambda: ended(submit(client, QUICK)).id in log_of(worker), "the host takes part again")
    return f"{seen}; back, it takes part"


def stopped(stage: Stage) -> str:
    """A worker is stopped by its signal: within its grace it hands the job back, and no step is computed again."""
    with stage.client() as client:
        job, worker = running(stage, client)
        began = monotonic()
        status = worker.stop()
        took = monotonic() - began
        expect(status is not None, f"it was killed after {worker.service.grace} s")
        done = ended(job)
    worker.start()
    expect((done.status, done.state.attempts) == ("successful", 1), done.state)
    return f"stopped within {took:.1f} of {worker.service.grace:.0f} s; the other ended the job, attempts 1"


def no_broker(stage: Stage) -> str:
    """Redis dies and comes back: a job submitted meanwhile ends."""
    stage.redis.kill()
    with stage.client() as client:
        job = submit(client, QUICK)
        stage.redis.start()
        return f"{ended(job).status}"


def no_database(stage: Stage) -> str:
    """PostgreSQL dies and comes back: the API says that it is not ready, then that it is; the job that ran ends."""
    with stage.client() as client:
        job, _ = running(stage, client)
        stage.postgres.kill()
        stage.wait(lambda: not stage.api.healthy(), "the health check of the API fails")
        stage.postgres.start()
        stage.wait(stage.api.healthy, "the health check of the API passes again")
        done = ended(job)
    expect(done.status == "successful", done.state)
    return f"unhealthy, healthy again; {done.status}, attempts {done.state.attempts}"


def all_stop(stage: Stage) -> str:
    """All stop by their signals within their grace."""
    took = {}
    for one in (*stage.workers, stage.api):
        began = monotonic()
        expect(one.stop() is not None, f"{one.host} was killed")
        took[one.host] = f"{one.host} {monotonic() - began:.1f} s"
    return ", ".join(took.values())


STEPS: tuple[Callable[[Stage], str], ...] = (
    databases, refused_without_a_key, key, api, rights, workers, spread, killed, cut_off, stopped, no_broker,
    no_database, all_stop,
)  # fmt: skip


def expect(condition: bool, seen: object) -> None:
    """Raises AssertionError with what was seen instead."""
    if not condition:
        raise AssertionError(seen)


def submit(client: Client, settings: dict[str, Any]) -> Job:
    """A job that nobody has run before."""
    return client.submit("goyal-2003", set={**settings, "description": secrets.token_hex()})


def ended(job: Job) -> Job:
    """The job, ended."""
    return job.wait(timeout=300.0)


def running(stage: Stage, client: Client) -> tuple[Job, Container]:
    """A slow job that has got some way, and the container that runs it."""
    job = submit(client, SLOW)
    stage.wait(lambda: job.refresh().progress > 0.1, "the job runs")
    stage.wait(lambda: any(job.id in log_of(worker) for worker in stage.workers), "a worker says so")
    return job, next(worker for worker in stage.workers if job.id in log_of(worker))


def taken_over(job: Job) -> str:
    """That another worker ended it, from a checkpoint."""
    done = ended(job)
    expect((done.status, done.state.attempts) == ("successful", 2), done.state)
    return f"{done.status}, attempts 2"


def log_of(container: Container) -> str:
    """All that it has said."""
    return container.log.read_text(errors="replace")
