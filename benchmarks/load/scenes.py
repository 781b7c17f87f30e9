"""What is measured, one function a scene. Latencies in seconds."""

from __future__ import annotations

import asyncio
import json
import random
import secrets
import time
from datetime import datetime
from pathlib import Path
from typing import Any

from benchmarks.load.clients import connect, listen, poll, submit_all
from benchmarks.load.connection import Connection
from service.cases import apply_settings, load_case
from service.jobs import Database, Reached, Status
from service.jobs.held import claim
from service.jobs.sharing import next_in_turn
from service.settings import Settings

POLLERS, FOR = 1000, 15.0
SUBMITTERS, SUBMITTED = (8, 24), 3000
LISTENERS, ROUNDS, TIMES = 200, 25, 200
PAUSE = 0.1
"""The most seconds from a job's end to the next submission. So long the API's feed sleeps between two looks, and a busy
worker needs less for a job: without a pause the next submission would meet them at the same moment every time."""
ONE_STEP = {"t_end": 0.01, "output.interval": 0.01, "numerics.dt_max": 0.01, "numerics.intervals": 50}


def case(number: int = 0) -> dict[str, Any]:
    """A small case that nobody has run; its physics change with `number`."""
    changed = ONE_STEP | {"loads.damping": 1e-6 * number, "description": secrets.token_hex()}
    return apply_settings(load_case("cantilever-vibration"), changed)


async def statuses(host: str, port: int, unchanged: bool) -> list[float]:
    """A thousand clients that look at their jobs once a second."""
    few, many = await connect(host, port, 1), await connect(host, port, POLLERS)
    ids, _ = await submit_all(few, [case(number) for number in range(100)])
    latencies = await poll(many, ids, FOR, unchanged)
    for connection in few + many:
        connection.close()
    return latencies


async def submissions(host: str, port: int, clients: int, many: int = SUBMITTED) -> tuple[float, list[float]]:
    """Submissions as fast as they are answered: how many a second, and their latencies."""
    connections = await connect(host, port, clients)
    cases = [case(number) for number in range(many)]
    start = time.perf_counter()
    _, latencies = await submit_all(connections, cases)
    rate = many / (time.perf_counter() - start)
    for connection in connections:
        connection.close()
    return rate, latencies


async def choices(host: str, port: int, settings: Settings) -> list[float]:
    """How long an idle worker takes to find whose turn it is, among all that wait, and to claim that job."""
    [connection] = await connect(host, port, 1)
    await submit_all([connection], [case(number) for number in range(TIMES)])
    connection.close()
    database, latencies = Database(settings.database_url), []
    for _ in range(TIMES):
        began = time.perf_counter()
        held = claim(database, next_in_turn(database) or "", 1e3, "load")
        latencies.append(time.perf_counter() - began)
        assert held is not None
        held.finish(Status.SUCCESSFUL, "completed", "", None, Reached())  # or it would be taken back in a later scene
    database.close()
    return latencies


async def first_step(host: str, port: int, settings: Settings) -> tuple[list[float], list[float], list[float]]:
    """From the request to a worker's claim, to its first step, and to the end of a job of one step.

    The first job is not counted: the worker may still compile or load its kernels.
    """
    connection = await Connection.open(host, port)
    sent_at: dict[str, float] = {}
    jobs = []
    for number in range(TIMES + 1):
        text = connection.text("POST", "/v1/jobs", json.dumps(case(number)).encode())
        now = time.time()
        job = json.loads((await connection.ask(text)).body)
        sent_at[job["id"]] = now
        while job["status"] in ("accepted", "running"):
            await asyncio.sleep(0.02)
            job = json.loads((await connection.ask(connection.text("GET", f"/v1/jobs/{job['id']}"))).body)
        jobs.append(job)
        await _pause()
    connection.close()
    stepped = under_way(settings.data / "logs" / "worker.log")
    claimed, ended = ([_unix(job[name]) - sent_at[job["id"]] for job in jobs[1:]] for name in ("started", "finished"))
    return claimed, [stepped[job["id"]] - sent_at[job["id"]] for job in jobs[1:]], ended


def under_way(log: Path) -> dict[str, float]:
    """When (Unix s) the worker had taken the first steps of each job, by its log."""
    lines = [json.loads(line) for line in log.read_text().splitlines() if line.startswith("{")]
    return {line["job"]: _unix(line["time"]) for line in lines if line["message"] == "under way"}


async def events(host: str, port: int) -> list[float]:
    """From what happens to a job to its arrival at many listeners."""
    latencies: list[float] = []
    [submitter] = await connect(host, port, 1)
    for number in range(ROUNDS):
        [job_id], _ = await submit_all([submitter], [case(number) | {"t_end": 5.0}])
        listeners = await connect(host, port, LISTENERS)
        ended = asyncio.Semaphore(0)

        def hear(kind: str, data: dict[str, Any], now: float, ended: asyncio.Semaphore = ended) -> None:
            if kind == "ended":
                latencies.append(now - _unix(data["time"]))
                ended.release()

        for connection in listeners:
            listen(connection, job_id, hear)
        for _ in listeners:
            await asyncio.wait_for(ended.acquire(), 120.0)
        for connection in listeners:
            connection.close()
        await _pause()
    submitter.close()
    return latencies


async def _pause() -> None:
    await asyncio.sleep(random.uniform(0.0, PAUSE))


def _unix(instant: str) -> float:
    return datetime.fromisoformat(instant).timestamp()
