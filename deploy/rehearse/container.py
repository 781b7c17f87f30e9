"""A container by the kernel's own means: namespaces of network, mounts, processes and host name, and a changed root."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from deploy.rehearse.compose import Service
from deploy.rehearse.image import Image
from deploy.rehearse.network import Network

DEVICES = ("null", "zero", "random", "urandom")


@dataclass
class Container:
    """One service of the image on a host of its own, as the compose file has it."""

    host: str
    service: Service
    image: Image
    network: Network
    volumes: Mapping[str, Path]
    log: Path
    process: subprocess.Popen[bytes] | None = field(default=None, init=False)

    def start(self) -> None:
        """Start its command."""
        with self.log.open("ab") as log:
            self.process = subprocess.Popen(self._command(self.service.command), stdin=subprocess.DEVNULL, stdout=log,
                                            stderr=log, start_new_session=True)  # fmt: skip

    def run(self, *command: str) -> subprocess.CompletedProcess[str]:
        """Run another command in a container of the same kind, as `docker compose run` does."""
        return subprocess.run(self._command(command), capture_output=True, text=True, check=False)

    def healthy(self) -> bool:
        """What its health check says, run beside it."""
        return self.run(*self.service.health).returncode == 0

    def signal(self, number: signal.Signals) -> None:
        """Send a signal to its first process, as an engine does."""
        assert self.process is not None
        [first] = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        os.kill(int(first), number)

    def stop(self) -> float | None:
        """Stop it by its signal; its exit status, or None if its grace was not enough and it was killed."""
        assert self.process is not None
        if self.process.poll() is None:
            self.signal(signal.Signals[self.service.stop_signal])
        try:
            return self.process.wait(self.service.grace)
        except subprocess.TimeoutExpired:
            self.kill()
            return None

    def kill(self) -> None:
        """End its first process without warning: the kernel ends all others of its namespace."""
        assert self.process is not None
        self.signal(signal.SIGKILL)
        self.process.wait()

    def _command(self, command: Sequence[str]) -> list[str]:
        space = ["ip", "netns", "exec", self.network.space(self.host)]
        apart = ["unshare", "--mount", "--uts", "--ipc", "--pid", "--fork"]
        return [*space, *apart, "sh", "-euc", self._script(command)]

    def _script(self, command: Sequence[str]) -> str:
        """Lay out the container's files, then give up all rights and become its command."""
        root, mounts = "/mnt", []
        mounts += [(str(self.volumes[name]), place) for name, place in self.service.mounts.items()]
        mounts += [(str(self.network.names), "/etc/hosts")]
        environment = self.image.environment | self.service.environment
        exported = [f"{name}={value}" for name, value in environment.items()]
        drop = ["setpriv", f"--reuid={self.image.user}", f"--regid={self.image.user}", "--clear-groups"]
        drop += ["--bounding-set=-all", "--inh-caps=-all"] * self.service.no_capabilities
        drop += ["--no-new-privs"] * self.service.no_new_privileges
        become = ["env", "-i", *exported, *self.image.entrypoint, *command]
        inside = f"cd {self.image.directory}; exec {shlex.join([*drop, *become])}"
        lines = [
            f"hostname {self.host}", "mount --make-rprivate /", f"mount --bind {self.image.files} {root}",
            f"mount -t tmpfs -o mode=755 dev {root}/dev", f"mkdir {root}/dev/shm",
            f"mount -t tmpfs shm {root}/dev/shm",
            *(f"touch {root}/dev/{name}; mount --bind /dev/{name} {root}/dev/{name}" for name in DEVICES),
            *(f"mount --bind {source} {root}{place}" for source, place in mounts),
            *(f"mount -t tmpfs -o mode=1777 tmp {root}{place}" for place in self.service.tmpfs),
            f"mount -t proc proc {root}/proc",
            *([f"mount -o remount,bind,ro {root}"] if self.service.read_only else []),
            f"exec chroot {root} /bin/sh -c {shlex.quote(inside)}",
        ]  # fmt: skip
        return "\n".join(lines)
