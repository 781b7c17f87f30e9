"""The images that are not ours, PostgreSQL and Redis: this machine's own programs, with the service's command,
environment and health check. What the official images do before their command is done here."""

from __future__ import annotations

import os
import pwd
import shutil
import signal
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from chaos.postgres import binaries
from deploy.rehearse.compose import Service
from deploy.rehearse.network import Network


@dataclass
class Other:
    """A program of this machine on a host of its own, as a user of its own."""

    service: Service
    network: Network
    data: Path
    log: Path
    user: str
    at_once: ClassVar[signal.Signals] = signal.SIGKILL
    """The signal that ends it and all its processes without ado."""
    process: subprocess.Popen[bytes] | None = field(default=None, init=False)

    def start(self) -> None:
        """Start it."""
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(self._there(self._prepared()), stdin=subprocess.DEVNULL, stdout=log,
                                            stderr=log, env=self._environment(), cwd=self.data)  # fmt: skip

    def healthy(self) -> bool:
        """What its health check says."""
        return subprocess.run(self._there(self.service.health), env=self._environment(), capture_output=True,
                              check=False).returncode == 0  # fmt: skip

    def kill(self) -> None:
        """End it at once."""
        assert self.process is not None
        self.process.send_signal(self.at_once)
        self.process.wait()

    def stop(self) -> None:
        """Stop it."""
        assert self.process is not None
        self.process.send_signal(signal.SIGINT)
        self.process.wait(30)

    def _prepared(self) -> Sequence[str]:
        owner = pwd.getpwnam(self.user)
        self.data.mkdir(mode=0o700, exist_ok=True)
        os.chown(self.data, owner.pw_uid, owner.pw_gid)
        return self.service.command

    def _environment(self) -> dict[str, str]:
        return {"PATH": f"{binaries()}:{os.environ['PATH']}", "LC_ALL": "C"} | self.service.environment

    def _there(self, command: Sequence[str]) -> list[str]:
        owner = pwd.getpwnam(self.user)
        return ["nsenter", f"--net=/run/netns/{self.network.space(self.service.name)}", f"--setuid={owner.pw_uid}",
                f"--setgid={owner.pw_gid}", *command]  # fmt: skip


class Redis(Other):
    """Redis; its command is the compose file's."""


class PostgreSQL(Other):
    """PostgreSQL, with the user, password and database that its environment names."""

    at_once = signal.SIGQUIT

    def _environment(self) -> dict[str, str]:
        return super()._environment() | {"PGHOST": "127.0.0.1"}  # its programs look for another socket than the image's

    def _prepared(self) -> Sequence[str]:
        super()._prepared()
        cluster = self.data / "cluster"
        if not cluster.exists():
            told, secret = self.service.environment, self.data / "secret"
            secret.write_text(told["POSTGRES_PASSWORD"])
            shutil.chown(secret, self.user)
            self._run("initdb", "-D", str(cluster), "--username", told["POSTGRES_USER"], f"--pwfile={secret}",
                      "--auth=scram-sha-256", "--encoding=UTF8")  # fmt: skip
            with (cluster / "pg_hba.conf").open("a") as rules:
                rules.write("host all all all scram-sha-256\n")
            single = ["postgres", "--single", "-D", str(cluster), "postgres"]
            self._run(*single, put=f"CREATE DATABASE {told['POSTGRES_DB']}\n")
        return ["postgres", "-D", str(cluster), "-c", "listen_addresses=*", "-c", "unix_socket_directories="]

    def _run(self, *command: str, put: str = "") -> None:
        subprocess.run(command, env=self._environment(), user=self.user, group=self.user, extra_groups=[], check=True,
                       capture_output=True, text=True, cwd=self.data, input=put)  # fmt: skip
