"""Slow connections by the thousand, while honest clients ask for the status of their job once a second."""

from __future__ import annotations

import asyncio
import resource
from collections.abc import Sequence
from contextlib import suppress
from statistics import quantiles

from benchmarks.load.clients import connect, poll
from chaos.attack.table import Row

HONEST = 0.050
"""Seconds that 99 of 100 honest requests may take at the most."""
AT_ONCE = 100
DRIP = 1.0
BEGUN = b"GET /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: "


class Slow(asyncio.Protocol):
    """A connection that sends a byte of its head now and then, or nothing."""

    def __init__(self, drips: bool) -> None:
        self._drips = drips
        self.open = False
        self._transport: asyncio.WriteTransport

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin."""
        assert isinstance(transport, asyncio.WriteTransport)
        self._transport, self.open = transport, True
        if self._drips:
            transport.write(BEGUN)

    def connection_lost(self, exc: Exception | None) -> None:
        """The server has had enough."""
        self.open = False

    def drip(self) -> None:
        """One byte more."""
        if self.open and self._drips:
            self._transport.write(b"x")

    def close(self) -> None:
        """Hang up."""
        if self.open:
            self._transport.close()


def slowloris(port: int, job_id: str, slow: int, clients: int, seconds: float) -> list[Row]:
    """Half of the slow connections drip a head without end, half say nothing."""
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    return asyncio.run(_slowloris(port, job_id, slow, clients, seconds))


async def _slowloris(port: int, job_id: str, slow: int, clients: int, seconds: float) -> list[Row]:
    alone = await _honest(port, job_id, clients, seconds / 3)
    connections, stopped = await _open(port, slow), asyncio.Event()
    dripping = asyncio.create_task(_drip(connections, stopped))
    besieged = await _honest(port, job_id, clients, seconds)
    await asyncio.sleep(2 * DRIP)
    still_open = sum(connection.open for connection in connections)
    stopped.set()
    await dripping
    for connection in connections:
        connection.close()
    p99, before = _p99(besieged), _p99(alone)
    return [
        Row(f"{slow} slow connections, {clients} honest clients",
            f"p99 of status {p99 * 1e3:.1f} ms (alone {before * 1e3:.1f} ms), {len(besieged)} answers",
            f"p99 <= {HONEST * 1e3:.0f} ms", p99 <= HONEST),
        Row(f"the same connections after {seconds:.0f} s", f"{still_open} still open", "0", still_open == 0),
    ]  # fmt: skip


async def _honest(port: int, job_id: str, clients: int, seconds: float) -> list[float]:
    connections = await connect("127.0.0.1", port, clients)
    try:
        return await poll(connections, [job_id], seconds, unchanged=False)
    finally:
        for connection in connections:
            connection.close()


async def _open(port: int, many: int) -> list[Slow]:
    opened: list[Slow] = []
    loop = asyncio.get_running_loop()
    while len(opened) < many:
        few = [Slow(drips=(len(opened) + number) % 2 == 0) for number in range(min(AT_ONCE, many - len(opened)))]
        opened += few
        with suppress(OSError):
            await asyncio.gather(*(loop.create_connection(lambda slow=slow: slow, "127.0.0.1", port)  # type: ignore[misc]
                                   for slow in few))  # fmt: skip
    return opened


async def _drip(connections: Sequence[Slow], stopped: asyncio.Event) -> None:
    while not stopped.is_set():
        for connection in connections:
            connection.drip()
        with suppress(TimeoutError):
            await asyncio.wait_for(stopped.wait(), DRIP)


def _p99(latencies: Sequence[float]) -> float:
    return quantiles(latencies, n=100)[98]
