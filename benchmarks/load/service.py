"""The service under test: `hockle serve` with its own data, on loopback, stopped when the block ends."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from hockle.client import Client


@dataclass(frozen=True)
class Service:
    """Where it answers."""

    address: str

    @property
    def host(self) -> str:
        """Its address without the port."""
        return urlsplit(self.address).hostname or ""

    @property
    def port(self) -> int:
        """Its port."""
        return urlsplit(self.address).port or 0


@contextmanager
def serving(workers: int) -> Iterator[Service]:
    """Run it, with a quota that lets one owner queue them all."""
    with tempfile.TemporaryDirectory(prefix="hockle-load-") as data:
        command = [sys.executable, "-m", "hockle", "serve", "--port", "0", "--workers", str(workers), "--data", data]
        environment = {**os.environ, "REDIS_URL": "", "HOCKLE_QUOTA": "1000000", "PYTHONPATH": str(Path.cwd())}
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
        try:
            assert process.stdout is not None
            yield Service(process.stdout.readline().split()[3].rstrip(","))
        finally:
            process.terminate()
            process.wait(120)


def finish(service: Service, job_id: str) -> dict[str, object]:
    """The job when it has ended."""
    with Client(service.address) as client:
        *_, job = client.follow(job_id)
    return job
