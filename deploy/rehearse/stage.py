"""All services of docker-compose.yml on their hosts, two of them workers."""

from __future__ import annotations

import os
import secrets
import time
from collections.abc import Callable
from pathlib import Path

from deploy.rehearse.compose import services
from deploy.rehearse.container import Container
from deploy.rehearse.image import ROOT, Image
from deploy.rehearse.network import Network
from deploy.rehearse.others import Other, PostgreSQL, Redis
from hockle_client import Client

WORKERS = ("worker-1", "worker-2")
PATIENCE = 300.0


class Stage:
    """The hosts and what runs on them."""

    def __init__(self, folder: Path, image: Image, network: Network) -> None:
        """Nothing runs yet."""
        self.folder, self.image, self.network = folder, image, network
        secret = {name: secrets.token_hex(24) for name in ("POSTGRES_PASSWORD", "REDIS_PASSWORD")}
        self._told = told = services(ROOT / "docker-compose.yml", secret)
        for host in ("api", *WORKERS, "redis", "postgres"):
            network.add(host)
        self.volumes = {name: self._volume(name) for name in told["api"].mounts}
        self.api = self._container("api", "api")
        self.workers = [self._container(host, "worker") for host in WORKERS]
        self.redis = Redis(told["redis"], network, folder / "redis", folder / "redis.log", "redis")
        self.postgres = PostgreSQL(told["postgres"], network, folder / "postgres", folder / "postgres.log", "postgres")
        self.key = ""

    def client(self) -> Client:
        """A client with the key, at the address where the engine would publish the API's port."""
        return Client(f"http://{self.network.addresses['api']}:8000", key=self.key)

    def close(self) -> None:
        """End what still runs."""
        every: tuple[Container | Other, ...] = (self.api, *self.workers, self.redis, self.postgres)
        for one in every:
            if one.process is not None and one.process.poll() is None:
                one.kill()

    def said(self) -> str:
        """The last words of all."""
        logs = sorted(self.folder.glob("*.log"))
        return "\n".join(f"--- {log.name}\n" + log.read_text(errors="replace")[-1500:] for log in logs)

    def wait(self, condition: Callable[[], object], what: str) -> None:
        """Until something is so. Raises TimeoutError with what all have said."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > deadline:
                raise TimeoutError(f"not within {PATIENCE:.0f} s: {what}\n{self.said()}")
            time.sleep(0.2)

    def _container(self, host: str, service: str) -> Container:
        return Container(host, self._told[service], self.image, self.network, self.volumes,
                         self.folder / f"{host}.log")  # fmt: skip

    def _volume(self, name: str) -> Path:
        """A volume takes the owner of the directory that it is mounted over."""
        made = self.folder / "volumes" / name
        made.mkdir(parents=True)
        like = (self.image.files / name).stat()
        os.chown(made, like.st_uid, like.st_gid)
        made.chmod(like.st_mode & 0o777)
        return made
