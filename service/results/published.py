"""The published datasets: files in a directory, or objects in an object store."""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from service.results.bucket import Bucket, StoreUnreachable
from service.results.durable import scratch, sha256_of, stamp_of

ROOM = 10_000_000_000
"""Bytes of copies that a host keeps."""
OBJECT = "object"
"""The stamp of what is no file."""
IN_USE = 60.0
"""Seconds for which a copy is kept in any case after it was asked for."""


class Datasets:
    """Datasets by the names of their files.

    They lie in a directory; but where there is a bucket, what is published from then on are objects in it. Of those
    `copies` holds what was read in part lately: the NetCDF library reads files only.
    """

    def __init__(self, directory: Path, copies: Path, objects: str = "") -> None:
        """`objects` is the s3:// address of the bucket, or empty."""
        self._directory, self._copies = directory, copies
        self._bucket = Bucket(objects) if objects else None

    def place(self, name: str, work: Path) -> Path:
        """Where a dataset is put together: where it stays, or in the directory of its job's work."""
        return (self._directory if self._bucket is None else work) / name

    def states(self, name: str) -> Path:
        """The directory of the states that are kept of the run whose dataset, or job, has this name."""
        return self._directory.parent / "beginnings" / name.partition(".")[0]

    def publish(self, path: Path) -> None:
        """Have what was put together lie where all can read it. Raises StoreUnreachable."""
        if self._bucket is not None:
            self._bucket.put(path, path.name)

    def discard(self, name: str) -> None:
        """Remove a dataset, if it is there. Raises StoreUnreachable."""
        (self._directory / name).unlink(missing_ok=True)
        if self._bucket is not None:
            self._bucket.remove(name)

    def find(self, name: str) -> Path | Bucket:
        """The file, or the bucket that may have it. Raises FileNotFoundError."""
        path = self._directory / name
        if path.is_file():
            return path
        if self._bucket is None:
            raise FileNotFoundError(errno.ENOENT, "there is no such dataset", name)
        return self._bucket

    def stamp(self, name: str) -> str:
        """What the file looks like (durable.stamp_of); an object has none. Raises FileNotFoundError."""
        place = self.find(name)
        return stamp_of(place) if isinstance(place, Path) else OBJECT

    def sha256(self, name: str, size: int) -> str:
        """The checksum of what is there. Raises FileNotFoundError, StoreUnreachable."""
        place = self.find(name)
        return sha256_of(place) if isinstance(place, Path) else place.sha256(name, size)

    def looks_good(self, name: str, stamp: str) -> bool:
        """Whether a dataset looks as it did when it was known to be good. An object is not looked at."""
        with suppress(FileNotFoundError):
            return self.stamp(name) == stamp
        return False

    def file(self, name: str, size: int, sha256: str) -> Path:
        """A dataset as a file, copied to this host if need be. Raises FileNotFoundError, StoreUnreachable."""
        place = self.find(name)
        return self._copy(place, name, size, sha256) if isinstance(place, Bucket) else place

    def _copy(self, bucket: Bucket, name: str, size: int, sha256: str) -> Path:
        path = self._copies / name
        with suppress(FileNotFoundError):
            os.utime(path)
            return path
        self._make_room(size)
        with scratch(path) as beside:
            copied = beside / name
            with copied.open("wb") as file:
                file.writelines(bucket.read(name, 0, size))
            if sha256_of(copied) != sha256:
                raise StoreUnreachable(errno.EIO, "the object is damaged", name)
            copied.replace(path)
        return path

    def _make_room(self, size: int) -> None:
        """Remove the copies that were asked for longest ago, until there is room for one more."""
        copies = sorted(self._kept())
        total = size + sum(bytes_ for _, bytes_, _ in copies)
        for used, bytes_, path in copies:
            if total <= ROOM or used > time.time() - IN_USE:
                return
            path.unlink(missing_ok=True)
            total -= bytes_

    def _kept(self) -> Iterator[tuple[float, int, Path]]:
        for path in self._copies.glob("*.nc"):
            with suppress(FileNotFoundError):  # another process has just made room
                status = path.stat()
                yield status.st_mtime, status.st_size, path
