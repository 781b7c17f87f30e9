"""A service of real processes, as `hockle serve` starts them, and hands on each of them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path

import redis

from service.settings import Settings
from worker.parent import die_with_parent

PATIENCE = 120.0
WORKERS = 2
TRIES = 10


class Served:
    """`hockle serve` over a data directory, always at the same port, with a clock that can be set wrong."""

    def __init__(self, settings: Settings, port: int) -> None:
        self.settings, self.address = settings, f"http://127.0.0.1:{port}"
        self.clock = settings.data / "clock"
        self.log = settings.data / "serve.log"
        self._command = [sys.executable, "-m", "hockle", "serve", "--port", str(port), "--workers", str(WORKERS)]
        self._environment = {
            **os.environ, **settings.environment(), "HOCKLE_CHAOS_CLOCK": str(self.clock),
            "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent / "clock"), str(Path.cwd())]),
        }  # fmt: skip
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, and wait until it says that it serves."""
        parent = os.getpid()
        for _ in range(TRIES):
            before = self.log.stat().st_size if self.log.exists() else 0
            with self.log.open("ab") as log:
                self.process = subprocess.Popen(self._command, stdout=log, stderr=log, env=self._environment,
                                                preexec_fn=partial(die_with_parent, parent))
            if self._serves(self.process, before):
                return
            time.sleep(1.0)  # the disk may be full just now
        raise RuntimeError(f"it does not start: {self.log.read_text()[-2000:]}")

    def stop(self) -> None:
        """Stop it as Ctrl-C does."""
        self.end(signal.SIGINT)

    def end(self, number: signal.Signals) -> None:
        """End it by a signal, and wait until none of its processes is left."""
        if self.process is None:
            return
        below = self.below(self.process.pid)
        self.process.send_signal(number)
        self.process.wait(PATIENCE)
        self.process = None
        wait_for(lambda: not any(is_alive(pid) for pid in below))

    def look_after(self) -> None:
        """Start it again if it has given up."""
        if self.process is not None and self.process.poll() is not None:
            self.start()

    def apis(self) -> list[int]:
        """The processes of the API."""
        return self._services("hockle api")

    def worker(self) -> int | None:
        """The Celery worker, the parent of those that run jobs."""
        return next(iter(self._services("hockle worker")), None)

    def broker(self) -> int | None:
        """Redis."""
        return next(iter(self._services("unixsocket:") or self._services("--unixsocket")), None)

    def children(self) -> list[int]:
        """The processes that run jobs."""
        worker = self.worker()
        return children(worker) if worker else []

    def redis(self) -> redis.Redis | None:
        """A connection to the broker."""
        broker = self.broker()
        words = command_line(broker).split() if broker else []
        path = next((word.removeprefix("unixsocket:") for word in words if ".sock" in word), None)
        return redis.Redis(unix_socket_path=path, socket_timeout=2.0) if path else None

    def below(self, pid: int) -> list[int]:
        """All processes that one has started, and those that they have."""
        started = children(pid)
        return started + [below for child in started for below in self.below(child)]

    def _serves(self, process: subprocess.Popen[bytes], offset: int) -> bool:
        """Whether it comes to say so, beyond what was `said` before."""
        wait_for(lambda: process.poll() is not None or b"serves at" in self.log.read_bytes()[offset:])
        return process.poll() is None

    def _services(self, words: str) -> list[int]:
        if self.process is None:
            return []
        return [pid for pid in children(self.process.pid) if words in command_line(pid)]


def wait_for(condition: Callable[[], object], patience: float = PATIENCE) -> bool:
    """Whether a condition came about in time."""
    deadline = time.monotonic() + patience
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.02)
    return True


def children(pid: int) -> list[int]:
    """The processes that one has started."""
    with suppress(OSError):
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return []


def command_line(pid: int) -> str:
    """The words with which a process was started."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ")
    return ""


def is_alive(pid: int) -> bool:
    """Whether a process runs, or is stopped, and is no zombie."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in ("Z", "X")
    return False


def send(pid: int | None, number: signal.Signals) -> bool:
    """Send a signal to a process of the service; False if there is none."""
    if pid is None:
        return False
    with suppress(ProcessLookupError):
        os.kill(pid, number)
        return True
    return False
