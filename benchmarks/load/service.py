"""The service under test, with data of its own, on loopback, stopped when the block ends."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from urllib.parse import urlsplit

import httpx

from hockle.supervisor import ENVIRONMENT
from service.api.listening import listen
from service.settings import Settings

VARIABLES = ENVIRONMENT | {"REDIS_URL": "", "HOCKLE_QUOTA": "1000000"}
APIS = 2


def cpu_time(word: str = "") -> float:
    """CPU time (s) that the processes have taken that this one has started, and those that they have; of those alone
    that have `called` in their command."""
    seconds = 0.0
    for pid in started(word):
        with suppress(OSError):  # it has just ended
            fields = Path("/proc", str(pid), "stat").read_text().rpartition(")")[2].split()
            seconds += sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")
    return seconds


def started(word: str = "") -> set[int]:
    """The processes that this one has started, and those that they have, which have `called` in their command."""
    parents, matching = {}, set()
    for entry in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            pid = int(entry.parent.name)
            parents[pid] = int(entry.read_text().rpartition(")")[2].split()[1])
            if word.encode() in entry.with_name("cmdline").read_bytes():
                matching.add(pid)
    family = {os.getpid()}
    while more := {pid for pid, parent in parents.items() if parent in family} - family:
        family |= more
    return (family - {os.getpid()}) & matching


@contextmanager
def with_workers(workers: int = 1, database: str = "") -> Iterator[tuple[str, int, Settings]]:
    """`hockle serve` with so many workers, on SQLite or the database at an address; host and port, and its
    settings."""
    with tempfile.TemporaryDirectory(prefix="hockle-load-") as data:
        command = [sys.executable, "-m", "hockle", "serve", "--port", "0", "--workers", str(workers)]
        command += ["--data", data]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=_environment(database))
        try:
            assert process.stdout is not None
            address = urlsplit(process.stdout.readline().split()[3].rstrip(","))
            yield address.hostname or "", address.port or 0, Settings(Path(data), database=database)
        finally:
            process.terminate()
            process.wait(120)


@contextmanager
def without_workers(database: str = "") -> Iterator[tuple[str, int, Settings]]:
    """The API processes alone, so that nothing computes beside them; host and port, and their settings."""
    with ExitStack() as cleanup:
        data = cleanup.enter_context(tempfile.TemporaryDirectory(prefix="hockle-load-"))
        sockets = [cleanup.enter_context(listening) for listening in listen("127.0.0.1", 0, many=APIS)]
        for listening in sockets:
            command = [sys.executable, "-m", "hockle", "api", "--fd", str(listening.fileno())]
            process = subprocess.Popen(command, env=_environment(database) | {"HOCKLE_DATA": data},
                                       pass_fds=[listening.fileno()])  # fmt: skip
            cleanup.callback(process.wait, 60)
            cleanup.callback(process.terminate)
        host, port = sockets[0].getsockname()
        deadline = time.monotonic() + 60.0
        for _ in range(20):  # new connections, so that each process has answered
            while time.monotonic() < deadline:
                try:
                    httpx.get(f"http://{host}:{port}/readyz", timeout=60.0, trust_env=False)
                    break
                except httpx.TransportError:
                    time.sleep(0.1)
        yield host, port, Settings(Path(data), database=database)


def _environment(database: str) -> dict[str, str]:
    return os.environ | VARIABLES | {"HOCKLE_DATABASE": database}
