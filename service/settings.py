"""What the service is told by its environment; every setting has a default that needs no file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit


@dataclass(frozen=True)
class Settings:
    """Where the service keeps things, and its times in seconds.

    `broker` is a kombu URL, or empty: messages then lie as files under `data` (no broker process).
    `lease`: how long a silent worker keeps its job. `attempts`: how often a lost job is tried.
    `ring_again`: how long an accepted job waits before the workers are told of it again.
    """

    data: Path = Path("var")
    broker: str = ""
    lease: float = 30.0
    attempts: int = 3
    ring_again: float = 30.0

    def __post_init__(self) -> None:
        for name in ("lease", "attempts", "ring_again"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} must be > 0, got {getattr(self, name)}")

    @property
    def database_url(self) -> str:
        """The registry's address for SQLAlchemy."""
        return f"sqlite:///{self.data.absolute() / 'registry.db'}"

    @property
    def datasets(self) -> Path:
        """The directory of the published datasets."""
        return self.data / "datasets"

    @property
    def locks(self) -> Path:
        """The directory of the jobs' lock files."""
        return self.data / "locks"

    @property
    def messages(self) -> Path:
        """The directory of the messages when no broker process runs."""
        return self.data / "messages"

    def make_directories(self) -> None:
        """Make the data directory and what it holds, for this user only."""
        for directory in (self.data, self.datasets, self.locks, self.messages):
            directory.mkdir(mode=0o700, parents=True, exist_ok=True)

    def environment(self) -> dict[str, str]:
        """The environment variables from which `from_environment` makes the same settings."""
        return {
            "HOCKLE_DATA": str(self.data.absolute()),
            "HOCKLE_LEASE": repr(self.lease),
            "HOCKLE_ATTEMPTS": str(self.attempts),
            "HOCKLE_RING_AGAIN": repr(self.ring_again),
            "REDIS_URL": self.broker,
        }


def from_environment(environment: Mapping[str, str] = os.environ) -> Settings:
    """Read HOCKLE_DATA, HOCKLE_LEASE, HOCKLE_ATTEMPTS, HOCKLE_RING_AGAIN and REDIS_URL.

    Raises ValueError that names the variable, its value and the rule.
    """
    return Settings(
        data=Path(environment.get("HOCKLE_DATA") or "var"),
        broker=_kombu_url(environment.get("REDIS_URL", "")),
        lease=_number(environment, "HOCKLE_LEASE", Settings.lease),
        attempts=int(_number(environment, "HOCKLE_ATTEMPTS", Settings.attempts)),
        ring_again=_number(environment, "HOCKLE_RING_AGAIN", Settings.ring_again),
    )


def _number(environment: Mapping[str, str], name: str, default: float) -> float:
    told = environment.get(name) or str(default)
    try:
        return float(told)
    except ValueError:
        raise ValueError(f"{name} must be a number, got {told!r}") from None


def _kombu_url(url: str) -> str:
    """A Redis address as kombu spells it: a Unix socket is redis+socket there, unix elsewhere."""
    parts = urlsplit(url)
    if parts.scheme == "unix":
        return f"redis+socket://{parts.path}"
    if url and parts.scheme not in ("redis", "rediss", "redis+socket"):
        raise ValueError(f"REDIS_URL must be redis://, rediss:// or unix://, got scheme {parts.scheme!r}")
    return url
