"""A network of namespaces: a bridge on this machine, and a host of its own for each container."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

SUBNET = "10.213.97"
"""The third part is arbitrary; no other machine is on this network."""


def ip(*words: str) -> None:
    """The command `ip`. Raises CalledProcessError."""
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


@dataclass
class Network:
    """Hosts by name, each with an address; `names` is the file that tells them to each other."""

    prefix: str
    names: Path
    addresses: dict[str, str] = field(default_factory=dict)

    def add(self, name: str) -> str:
        """A new host, by its address."""
        address, link = f"{SUBNET}.{len(self.addresses) + 2}", f"{self.prefix}{len(self.addresses)}"
        space = self.space(name)
        ip("netns", "add", space)
        self.addresses[name] = address
        ip("link", "add", link, "type", "veth", "peer", "name", "eth0", "netns", space)
        ip("link", "set", link, "master", self.prefix, "up")
        for words in (["link", "set", "lo", "up"], ["address", "add", f"{address}/24", "dev", "eth0"],
                      ["link", "set", "eth0", "up"]):  # fmt: skip
            ip("-n", space, *words)
        lines = ["127.0.0.1 localhost", *(f"{its} {host}" for host, its in self.addresses.items())]
        self.names.write_text("\n".join(lines) + "\n")
        return address

    def cut(self, name: str, *, off: bool) -> None:
        """Pull a host's plug, or put it in again."""
        ip("-n", self.space(name), "link", "set", "eth0", "down" if off else "up")

    def space(self, name: str) -> str:
        """The name of a host's namespace."""
        return f"{self.prefix}-{name}"


@contextmanager
def network(names: Path) -> Iterator[Network]:
    """A network while the block runs. Needs root."""
    made = Network(f"hk{os.getpid() % 10**6}", names)
    ip("link", "add", made.prefix, "type", "bridge")
    try:
        ip("address", "add", f"{SUBNET}.1/24", "dev", made.prefix)
        ip("link", "set", made.prefix, "up")
        yield made
    finally:
        for name in made.addresses:
            with suppress(subprocess.CalledProcessError):
                ip("netns", "del", made.space(name))
        ip("link", "del", made.prefix)
