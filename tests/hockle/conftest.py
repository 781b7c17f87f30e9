"""The whole service as real processes, with short leases, and ways to end some of them."""

from __future__ import annotations

import os
import secrets
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cached_property
from pathlib import Path
from typing import Any

import httpx
import pytest

import solver
from chaos.campaign import free_port
from chaos.postgres import Postgres, binaries, postgres
from hockle.broker import redis_binary
from hockle_client import Client
from service.cases import apply_settings, load_case

QUICK = {"t_end": 0.5, "output.interval": 0.1, "numerics.intervals": 20}
SLOW = {"t_end": 2.0, "output.interval": 0.1, "numerics.dt_max": 0.0005}
SERVE = "import sys, hockle.supervisor as serve; from hockle.cli import main; serve.APIS = {}; sys.exit(main())"
SHORT_LEASES = {"HOCKLE_LEASE": "5"}  # a machine with other work to do may hold a beat back for seconds


class Server:
    """A running `hockle serve`."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process

    @cached_property
    def first_line(self) -> str:
        """What it says when it serves, or why it does not; waits for that."""
        return self.process.stdout.readline()

    @property
    def address(self) -> str:
        """Where it serves, once it does; empty if it does not."""
        return self.first_line.split()[3].rstrip(",") if "serves at" in self.first_line else ""

    @property
    def ready(self) -> bool:
        """Whether it says that it can do all it is there for."""
        with suppress(httpx.TransportError):
            return httpx.get(f"{self.address}/readyz", timeout=20.0, trust_env=False).status_code == 200
        return False

    def below(self, pid: int | None = None) -> list[int]:
        """The ids of all processes that this server, or one of its processes, has started."""
        top = pid or self.process.pid
        try:
            children = [int(c) for c in Path(f"/proc/{top}/task/{top}/children").read_text().split()]
        except FileNotFoundError:
            return []
        return children + [grandchild for child in children for grandchild in self.below(child)]

    def service(self, words: str) -> int:
        """The process directly below the server in whose command line these words stand."""
        below = [int(c) for c in Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
                 .read_text().split()]  # fmt: skip
        return next(pid for pid in below if words in command_line(pid))

    def kill(self, pid: int) -> None:
        """End one of the server's own processes, without warning."""
        assert pid in self.below()
        os.kill(pid, signal.SIGKILL)


def command_line(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ")
    except (FileNotFoundError, ProcessLookupError):
        return ""


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


@contextmanager
def serving(data: Path, tree: Path | None = None, port: int = 0, apis: int = 1, **told: str) -> Iterator[Server]:
    """A server that keeps what is its own in `data`, of the packages in `tree` if one is named; `told` are more
    environment variables. Each of the processes of its API takes two seconds to start."""
    solver.warm()  # else the first worker may compile for longer than a test waits
    command = [sys.executable, "-c", SERVE.format(apis), "serve", "--port", str(port), "--workers", "1",
               "--data", str(data)]
    environment = {**os.environ, **SHORT_LEASES, "REDIS_URL": "", **told}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               env=environment, cwd=tree)  # fmt: skip
    try:
        yield Server(process)
    finally:
        process.terminate()
        process.wait(60)
        process.stdout.close()


@pytest.fixture
def start():
    """`with start(directory) as server:` runs a server of one's own."""
    return serving


@pytest.fixture
def postgresql() -> Iterator[Postgres]:
    """A PostgreSQL for several hosts."""
    if binaries() is None:
        pytest.skip("no PostgreSQL on this machine")
    with postgres(synced=False) as running:
        yield running


@pytest.fixture
def broker() -> Iterator[int]:
    """The port on loopback of a Redis for several hosts."""
    if redis_binary() is None:
        pytest.skip("no Redis on this machine")
    port = free_port()
    process = subprocess.Popen([str(redis_binary()), "--port", str(port), "--bind", "127.0.0.1", "--save", ""],
                               stdout=subprocess.DEVNULL)  # fmt: skip
    try:
        yield port
    finally:
        process.terminate()
        process.wait(60)


@pytest.fixture(scope="module")
def server(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server that the tests of a module share; the module may say of how many processes its API is."""
    with serving(tmp_path_factory.mktemp("data"), apis=getattr(request.module, "APIS", 1)) as server:
        assert server.address, server.first_line + server.process.stdout.read()
        yield server


@pytest.fixture
def client(server: Server) -> Iterator[Client]:
    with Client(server.address) as client:
        yield client


@pytest.fixture
def quick() -> dict[str, Any]:
    """A case of a moment, which nobody has run before."""
    return apply_settings(load_case("goyal-2003"), QUICK | {"description": secrets.token_hex()})


@pytest.fixture
def slow() -> dict[str, Any]:
    """A case of some seconds, which nobody has run before."""
    return apply_settings(load_case("goyal-2003"), SLOW | {"description": secrets.token_hex()})


@pytest.fixture
def is_alive():
    """Whether a process still runs."""
    return alive
