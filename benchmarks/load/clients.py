"""The crowds: pollers, submitters, listeners. Each gives its latencies in seconds."""

from __future__ import annotations

import asyncio
import json
import random
import time
from collections.abc import Callable, Sequence
from typing import Any

from benchmarks.load.connection import Connection

AT_ONCE = 50


class Unexpected(Exception):
    """The service answered what it should not."""


async def connect(host: str, port: int, many: int) -> list[Connection]:
    """Many keep-alive connections, opened a few at a time."""
    opened: list[Connection] = []
    while len(opened) < many:
        few = min(AT_ONCE, many - len(opened))
        opened += await asyncio.gather(*(Connection.open(host, port) for _ in range(few)))
    return opened


async def submit_all(
    connections: Sequence[Connection], cases: Sequence[dict[str, Any]]
) -> tuple[list[str], list[float]]:
    """Submit the cases, each connection one after the other; ids and latencies."""
    waiting = iter([connections[0].text("POST", "/v1/jobs", json.dumps(case).encode()) for case in cases])
    ids: list[str] = []
    latencies: list[float] = []

    async def submit(connection: Connection) -> None:
        for text in waiting:
            answer = await connection.ask(text)
            if answer.status != 202:
                raise Unexpected(f"a submission was answered {answer.status}: {answer.body[:200]!r}")
            ids.append(json.loads(answer.body)["id"])
            latencies.append(answer.seconds)

    await asyncio.gather(*map(submit, connections))
    return ids, latencies


async def poll(connections: Sequence[Connection], ids: Sequence[str], seconds: float, unchanged: bool) -> list[float]:
    """Each connection asks once a second for its job's status, all out of step; latencies.

    `unchanged`: each sends the ETag that it has, and 304 is expected.
    """
    latencies: list[float] = []
    expected = 304 if unchanged else 200
    texts = []
    for place, connection in enumerate(connections):  # one by one: a rush of a thousand is another scene
        path = f"/v1/jobs/{ids[place % len(ids)]}"
        etag: dict[str, Any] = {}
        if unchanged:
            etag["If_None_Match"] = (await connection.ask(connection.text("GET", path))).etag
        texts.append(connection.text("GET", path, **etag))
    end = time.perf_counter() + seconds

    async def ask(connection: Connection, text: bytes) -> None:
        await asyncio.sleep(random.random())
        while time.perf_counter() < end:
            due = time.perf_counter() + 1.0
            answer = await connection.ask(text)
            if answer.status != expected:
                raise Unexpected(f"a status was answered {answer.status}, not {expected}")
            latencies.append(answer.seconds)
            await asyncio.sleep(max(0.0, due - time.perf_counter()))

    await asyncio.gather(*map(ask, connections, texts))
    return latencies


def listen(connection: Connection, job_id: str, hear: Callable[[str, dict[str, Any], float], None]) -> None:
    """Follow a job's events: `hear` gets kind, data and the time of arrival (Unix seconds)."""
    kind = ""

    def on_line(line: bytes, now: float) -> None:
        nonlocal kind
        name, _, value = line.rstrip(b"\r").partition(b": ")
        if name == b"event":
            kind = value.decode()
        elif name == b"data":
            hear(kind, json.loads(value), now)

    connection.stream(connection.text("GET", f"/v1/jobs/{job_id}/events"), on_line)
