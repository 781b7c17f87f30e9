"""A PostgreSQL of one's own: in a directory, on a Unix socket there, gone afterwards."""

from __future__ import annotations

import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import Any

import psycopg

START_WITHIN = 60.0
OPTIONS: Mapping[str, str] = {"listen_addresses": "", "max_connections": "200", "shared_buffers": "32MB",
                              "max_wal_size": "64MB"}


def binaries() -> Path | None:
    """The directory of the newest initdb and postgres on this machine."""
    installed = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), key=lambda path: float(path.parts[-3]))
    if installed:
        return installed[-1].parent
    on_path = shutil.which("initdb")
    return Path(on_path).resolve().parent if on_path else None


class Postgres:
    """A running server. It refuses to run as root, so then it runs as another user."""

    def __init__(self, binaries: Path, directory: Path, synced: bool = True) -> None:
        """Make a new cluster in `directory`, with the programs in `binaries`, and start it.

        One that is not `synced` never waits for the disk: only with the machine's power could it lose something.
        """
        self._bin, self.directory, self._data = binaries, directory, directory / "data"
        self._options = OPTIONS if synced else {**OPTIONS, "fsync": "off"}
        self._user = "postgres" if os.geteuid() == 0 else None
        if self._user:
            owner = pwd.getpwnam(self._user)
            os.chown(directory, owner.pw_uid, owner.pw_gid)
        self._run("initdb", "--auth=trust", "--username=hockle", "--encoding=UTF8", "--locale=C",
                  *([] if synced else ["--no-sync"]), "-D", str(self._data))  # fmt: skip
        self.start()

    def start(self) -> None:
        """Start it, and wait until it answers."""
        options = [f"-c{name}={value}" for name, value in self._options.items()]
        with (self.directory / "log").open("ab") as log:
            self.process = subprocess.Popen(
                [self._bin / "postgres", "-D", str(self._data), "-k", str(self.directory), *options],
                stdout=log, stderr=log, stdin=subprocess.DEVNULL, user=self._user, cwd="/",
            )  # fmt: skip
        deadline = time.monotonic() + START_WITHIN
        while not self._answers():
            if time.monotonic() > deadline:
                raise TimeoutError((self.directory / "log").read_text()[-2000:])
            time.sleep(0.05)

    @property
    def ended(self) -> bool:
        """Whether it has given up."""
        return self.process.poll() is not None

    def kill(self) -> None:
        """End it as a power cut would, but for what the system keeps."""
        self.process.send_signal(signal.SIGQUIT)
        self.process.wait(START_WITHIN)

    def stop(self) -> None:
        """Shut it down."""
        self.process.send_signal(signal.SIGINT)
        self.process.wait(START_WITHIN)

    def url(self, name: str = "postgres") -> str:
        """The address of one of its databases."""
        return f"postgresql+psycopg://hockle@/{name}?host={self.directory}"

    def create(self, name: str) -> str:
        """Make an empty database and give its address."""
        with self._connect() as connection:
            connection.execute(f'CREATE DATABASE "{name}"')
        return self.url(name)

    def _connect(self) -> psycopg.Connection[Any]:
        return psycopg.connect(host=str(self.directory), user="hockle", dbname="postgres", autocommit=True,
                               connect_timeout=2)

    def _answers(self) -> bool:
        try:
            self._connect().close()
        except psycopg.OperationalError:
            return False
        return True

    def _run(self, name: str, *arguments: str) -> None:
        subprocess.run([self._bin / name, *arguments], check=True, capture_output=True, user=self._user, cwd="/")


@contextmanager
def postgres(
    disk: Callable[[Path], AbstractContextManager[object]] = nullcontext, synced: bool = True
) -> Iterator[Postgres]:
    """A server while the block runs, in a directory where `disk` is mounted.

    Raises FileNotFoundError where none is installed.
    """
    programs = binaries()
    if programs is None:
        raise FileNotFoundError("no initdb: install PostgreSQL")
    # a socket's path must be short; and where another user runs it, TMPDIR may be closed to that user
    directory = Path(tempfile.mkdtemp(prefix="hockle-pg-", dir="/tmp" if os.geteuid() == 0 else None))
    try:
        with disk(directory):
            server = Postgres(programs, directory, synced)
            try:
                yield server
            finally:
                server.stop()
    finally:
        shutil.rmtree(directory, ignore_errors=True)
