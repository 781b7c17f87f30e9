"""What arrives piece by piece: events, and a dataset's bytes."""

from __future__ import annotations

import hashlib
import json
from typing import BinaryIO

import httpx

from hockle_client.documents import Event
from hockle_client.problems import DamagedDataset


class Events:
    """Server-sent events, from their lines."""

    def __init__(self) -> None:
        self._id, self._kind, self._data = 0, "message", ""

    def take(self, line: str) -> Event | None:
        """The event that this line completes, if it does."""
        if not line:
            event = Event(id=self._id, kind=self._kind, data=json.loads(self._data)) if self._data else None
            self._kind, self._data = "message", ""
            return event
        name, _, value = line.partition(":")
        value = value.removeprefix(" ")
        if name == "id":
            self._id = int(value)
        elif name == "event":
            self._kind = value
        elif name == "data":
            self._data += value
        return None


class Download:
    """A dataset on its way into an empty file; where the connection breaks it goes on from there."""

    def __init__(self, file: BinaryIO) -> None:
        self._file, self._digest, self._etag = file, hashlib.sha256(), ""
        self.size = 0

    @property
    def headers(self) -> dict[str, str]:
        """Asks for what is missing."""
        return {"Range": f"bytes={self.size}-", "If-Range": self._etag} if self.size else {}

    def begin(self, response: httpx.Response) -> None:
        """What comes now is the rest, or all of it once more."""
        if response.status_code != 206:
            self._file.seek(0)
            self._file.truncate()
            self._digest, self.size = hashlib.sha256(), 0
        self._etag = response.headers.get("etag", "")

    def take(self, chunk: bytes) -> None:
        """Write some bytes. Raises OSError."""
        self._file.write(chunk)
        self._digest.update(chunk)
        self.size += len(chunk)

    def check(self) -> None:
        """Raises DamagedDataset if what was written is not what the server has; then it starts anew."""
        if f'"{self._digest.hexdigest()}"' != self._etag:
            self.size = 0
            raise DamagedDataset("the dataset arrived damaged, its sha256 is another: fetch it again")
