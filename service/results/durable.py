"""Files that are there whole or not at all, whatever ends the process or the machine."""

from __future__ import annotations

import fcntl
import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path


def sync(path: Path) -> None:
    """Bring a file's or a directory's content to the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextmanager
def syncing(path: Path) -> Iterator[None]:
    """Bring a file's content to the disk while the block runs, which may read it. Raises OSError, MemoryError."""
    with ThreadPoolExecutor(1, "sync") as thread:
        try:
            synced = thread.submit(sync, path)
        except RuntimeError as error:
            raise MemoryError("there is no memory for a thread") from error
        yield
        synced.result()


def write_whole(path: Path, content: bytes | memoryview) -> None:
    """Write a file beside its place, to the disk, then under its name. Raises OSError."""
    beside = path.with_name(f"{path.name}.part")
    with beside.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    beside.replace(path)
    sync(path.parent)


def discard(path: Path) -> None:
    """Remove a file, and free its room even if somebody still has it open."""
    with suppress(OSError):
        os.truncate(path, 0)
        path.unlink()


def sha256_of(path: Path) -> str:
    """The checksum of a file, hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def stamp_of(path: Path) -> str:
    """What tells cheaply that a file is as it was: size, time of its last change, inode. Raises FileNotFoundError."""
    stat = path.stat()
    return f"{stat.st_size} {stat.st_mtime_ns} {stat.st_ino}"


def size_of(directory: Path) -> int:
    """Bytes of the files in a directory, none if it is not there."""
    if not directory.is_dir():
        return 0
    return sum(entry.stat().st_size for entry in os.scandir(directory) if entry.is_file())


@contextmanager
def scratch(target: Path) -> Iterator[Path]:
    """A hidden directory beside `target` while the block runs.

    It is locked while its process lives; what killed processes have left for the same target is removed.
    """
    prefix = f".{target.name}.work-"
    _remove_abandoned(target.parent, prefix)
    directory = Path(tempfile.mkdtemp(prefix=prefix, dir=target.parent))
    lock = os.open(directory, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield directory
    finally:
        shutil.rmtree(directory, ignore_errors=True)
        os.close(lock)


def _remove_abandoned(directory: Path, prefix: str) -> None:
    for path in directory.glob(f"{prefix}*"):
        try:
            descriptor = os.open(path, os.O_RDONLY)
        except FileNotFoundError:
            continue  # its process has just ended
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(path, ignore_errors=True)
        except BlockingIOError:
            pass  # its process lives
        finally:
            os.close(descriptor)
