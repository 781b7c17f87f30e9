"""docker-compose.yml, as far as the rehearsal follows it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

VARIABLE = re.compile(r"\$\{(\w+)(?::\?([^}]*))?\}")
FOLLOWED = frozenset(
    ("build", "image", "init", "read_only", "tmpfs", "cap_drop", "security_opt", "restart", "environment", "volumes",
     "depends_on", "command", "ports", "networks", "healthcheck", "stop_signal", "stop_grace_period", "shm_size"))
"""What a service may say. `init`, `restart` and `shm_size` are an engine's: the rehearsal itself starts and stops."""


@dataclass(frozen=True)
class Service:
    """One service: what it runs, and what it is allowed."""

    name: str
    command: list[str]
    environment: dict[str, str]
    mounts: dict[str, str]
    """The directory of each volume, by the volume's name."""
    tmpfs: list[str]
    read_only: bool
    no_capabilities: bool
    no_new_privileges: bool
    networks: list[str]
    health: list[str]
    stop_signal: str
    grace: float


def services(path: Path, variables: Mapping[str, str]) -> dict[str, Service]:
    """The services of a compose file. Raises ValueError for what this cannot follow."""
    told = yaml.safe_load(_filled(path.read_text(), variables))
    return {name: _service(name, one) for name, one in told["services"].items()}


def _filled(text: str, variables: Mapping[str, str]) -> str:
    text = "\n".join(line for line in text.splitlines() if not line.lstrip().startswith("#"))
    missing = {match[1] for match in VARIABLE.finditer(text)} - set(variables)
    if missing:
        raise ValueError(f"{', '.join(sorted(missing))} must be set")
    return VARIABLE.sub(lambda match: variables[match[1]], text)


def _service(name: str, told: dict[str, Any]) -> Service:
    if strange := set(told) - FOLLOWED:
        raise ValueError(f"service {name}: the rehearsal does not follow {', '.join(sorted(strange))}")
    test = told.get("healthcheck", {}).get("test", ["CMD"])
    if test[0] != "CMD":
        raise ValueError(f"service {name}: a health check must be a CMD, got {test[0]!r}")
    return Service(
        name=name, command=told.get("command", []), environment=told.get("environment", {}),
        mounts=dict(volume.split(":") for volume in told.get("volumes", ())), tmpfs=told.get("tmpfs", []),
        read_only=told.get("read_only", False), no_capabilities=told.get("cap_drop") == ["ALL"],
        no_new_privileges="no-new-privileges:true" in told.get("security_opt", ()), networks=told.get("networks", []),
        health=test[1:], stop_signal=told.get("stop_signal", "SIGTERM"),
        grace=float(told.get("stop_grace_period", "10s").removesuffix("s")),
    )  # fmt: skip
