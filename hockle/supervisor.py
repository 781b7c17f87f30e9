"""Broker, API and worker as one: started together, restarted when one dies or stands still, stopped together."""

from __future__ import annotations

import fcntl
import signal
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from http.client import HTTPConnection, HTTPException
from pathlib import Path

from hockle.broker import answers, redis_binary, redis_child, short_directory
from hockle.children import Child
from hockle.failure import Failure
from hockle.here import make_directories
from hockle.parts import SINGLE_THREADED, listening_on
from hockle.rotation import rotate
from service.pulse import last_beat
from service.settings import Settings

START_WITHIN = 120.0
APIS = 2
"""Processes that answer requests: one of them may be busy, or dead for a moment."""

HOCKLE = (sys.executable, "-m", "hockle")

ENVIRONMENT = SINGLE_THREADED | {"MALLOC_ARENA_MAX": "2"}
"""Two heaps, where glibc would give the threads of an API
process sixteen on two cores, each as large as the largest answer that some thread ever made in it."""


class Services:
    """The processes of the service, as a context: inside it they run, after it none is left."""

    def __init__(self, settings: Settings, host: str = "127.0.0.1", port: int = 8000,
                 workers: int = 1) -> None:
        """Nothing is started yet. Port 0 is any free one. Raises Failure for a host
        other than loopback while there is no API key."""
        self.settings, self._workers = settings, workers
        self._host, self._port = host, port
        self._cleanup = ExitStack()
        self.children: dict[str, Child] = {}

    def __enter__(self) -> Services:
        try:
            self._start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    @property
    def address(self) -> str:
        """Where the API answers."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"http://{host}:{self._port}"

    def look_after(self) -> None:
        """Start again what has died, and what stands still; begin full logs anew."""
        for child in self.children.values():
            rotate(child.log, self.settings.log_bytes)
            if happened := child.look_after():
                print(f"the {child.name} {happened}; see {child.log}", file=sys.stderr, flush=True)

    def stop(self) -> None:
        """Stop every process and remove the broker's socket; further signals do not hinder it."""
        with _SignalsIgnored():
            working = [child for name, child in self.children.items() if name != "broker"]
            for child in working:
                child.ask_to_stop()
            for child in working:
                child.make_stop()
            if broker := self.children.get("broker"):
                broker.ask_to_stop()
                broker.make_stop()
            self.children.clear()
            self._cleanup.close()

    def _start(self) -> None:
        make_directories(self.settings)
        sockets = listening_on(self.settings, self._host, self._port, APIS)
        for listening in sockets:
            self._cleanup.enter_context(listening)
        self._port = sockets[0].getsockname()[1]
        self._hold_data_directory()
        for pulse in self.settings.pulses.iterdir():
            pulse.unlink()
        self._start_broker()
        environment = self.settings.environment() | ENVIRONMENT
        apis = [f"api-{number}" for number in range(1, APIS + 1)]
        for name, listening in zip(apis, sockets, strict=True):
            api = [*HOCKLE, "api", "--fd", str(listening.fileno())]
            self._add(Child(name, api, self._log(name), self._beat("api"), environment, keep_fds=(listening.fileno(),)))
        worker = [*HOCKLE, "worker", "--workers", str(self._workers)]
        self._add(Child("worker", worker, self._log("worker"), self._beat("worker"), environment,
                        stop_signal=signal.SIGQUIT))
        for name in apis:
            self._await(name, self._api_answers)

    def _start_broker(self) -> None:
        binary = None if self.settings.broker else redis_binary()
        if binary is None:
            return
        socket_path = self._cleanup.enter_context(short_directory(self.settings.data / "broker")) / "broker.sock"
        self._add(redis_child(binary, socket_path, self.settings.data / "broker", self._log("broker")))
        self._await("broker", lambda: answers(socket_path))
        self.settings = replace(self.settings, broker=f"redis+socket://{socket_path}")

    def _hold_data_directory(self) -> None:
        lock = self._cleanup.enter_context((self.settings.data / "serve.lock").open("w"))
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Failure(f"another hockle serves from {self.settings.data.absolute()}: stop it, "
                          "or give this one another directory with --data") from None

    def _beat(self, kind: str) -> Callable[[int], int]:
        return lambda pid: last_beat(self.settings.pulses, kind, pid)

    def _add(self, child: Child) -> None:
        self.children[child.name] = child
        child.start()

    def _log(self, name: str) -> Path:
        logs = self.settings.data / "logs"
        logs.mkdir(mode=0o700, exist_ok=True)
        return logs / f"{name}.log"

    def _await(self, name: str, ready: Callable[[], bool]) -> None:
        deadline = time.monotonic() + START_WITHIN
        while not ready():
            child = self.children[name]
            if child.ended or time.monotonic() > deadline:
                raise Failure(f"the {name} did not start; {_last_words(child.log)}")
            time.sleep(0.05)

    def _api_answers(self) -> bool:
        connection = HTTPConnection(self._host, self._port, timeout=1.0)
        try:
            connection.request("GET", "/readyz")
            return connection.getresponse().status == 200
        except (OSError, HTTPException):
            return False
        finally:
            connection.close()


def stop_on_signals() -> None:
    """Have SIGTERM and SIGHUP do what Ctrl-C does, and SIGINT too where a shell's background made it ignored."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)


class _SignalsIgnored:
    """While the block runs, no signal interrupts it."""

    def __enter__(self) -> None:
        numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
        self._before = {number: signal.signal(number, signal.SIG_IGN) for number in numbers}

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)


def _last_words(log: Path) -> str:
    return f"its last words, in {log}:\n" + "\n".join(log.read_text(errors="replace").splitlines()[-15:])
