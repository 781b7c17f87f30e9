"""Files in one place of an object store that speaks S3: `s3://bucket/prefix`."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

CHUNK = 1_000_000
NOT_THERE = ("NoSuchKey", "404")


class StoreUnreachable(OSError):
    """The object store does not answer, or refuses."""


class Bucket:
    """The objects below one prefix. Address, region and secrets are boto3's own settings (AWS_...)."""

    def __init__(self, url: str) -> None:
        parts = urlsplit(url)
        self._bucket, self._prefix = parts.netloc, parts.path.strip("/")

    def put(self, path: Path, name: str) -> None:
        """Store a file: afterwards it is there whole, otherwise not at all. Raises StoreUnreachable."""
        from boto3.s3.transfer import TransferConfig

        with _answering(name), path.open("rb") as file:
            client().upload_fileobj(file, self._bucket, self._key(name), Config=TransferConfig(use_threads=False))

    def read(self, name: str, start: int, stop: int) -> Iterator[bytes]:
        """The bytes from `start` up to `stop`, as they come. Raises FileNotFoundError, StoreUnreachable."""
        with _answering(name):
            answer = client().get_object(Bucket=self._bucket, Key=self._key(name), Range=f"bytes={start}-{stop - 1}")
        return _chunks(name, answer["Body"])

    def sha256(self, name: str, size: int) -> str:
        """The checksum of an object, hexadecimal. Raises FileNotFoundError, StoreUnreachable."""
        digest = hashlib.sha256()
        for chunk in self.read(name, 0, size):
            digest.update(chunk)
        return digest.hexdigest()

    def remove(self, name: str) -> None:
        """Remove an object, if it is there. Raises StoreUnreachable."""
        with _answering(name):
            client().delete_object(Bucket=self._bucket, Key=self._key(name))

    def _key(self, name: str) -> str:
        return f"{self._prefix}/{name}" if self._prefix else name


@cache
def client() -> Any:
    """One for all threads of a process; not to be made before a fork. boto3 comes with the extra `s3` only."""
    import boto3
    from botocore.config import Config

    return boto3.session.Session().client("s3", config=Config(connect_timeout=5, retries={"mode": "standard"}))


def _chunks(name: str, body: Any) -> Iterator[bytes]:
    with _answering(name), closing(body):
        while chunk := body.read(CHUNK):
            yield chunk


@contextmanager
def _answering(name: str) -> Iterator[None]:
    from botocore.exceptions import BotoCoreError, ClientError

    try:
        yield
    except ClientError as error:
        if error.response["Error"]["Code"] in NOT_THERE:
            raise FileNotFoundError(name) from error
        raise StoreUnreachable(f"the object store refuses {name}: {error}") from error
    except BotoCoreError as error:
        raise StoreUnreachable(f"the object store cannot be reached: {error}") from error
