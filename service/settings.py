"""Settings of the service: its environment, over one settings file, over defaults that need neither."""

from __future__ import annotations

import errno
import os
import tomllib
from collections.abc import Mapping
from dataclasses import fields
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import urlsplit

from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass
from sqlalchemy import make_url
from sqlalchemy.exc import ArgumentError

from service.jobs.job import LEAST_MEMORY, Limits
from service.meaning import means

FILE = "HOCKLE_SETTINGS"
"""The variable that names the settings file (TOML, with the names of the fields below)."""

Positive = Field(gt=0, allow_inf_nan=False)


def _kombu_url(url: str) -> str:
    """A Redis address as kombu spells it: a Unix socket is redis+socket there, unix elsewhere."""
    parts = urlsplit(url)
    if parts.scheme == "unix":
        return f"redis+socket://{parts.path}"
    if url and parts.scheme not in ("redis", "rediss", "redis+socket"):
        raise ValueError(f"must be redis://, rediss:// or unix://, got scheme {parts.scheme!r}")
    if parts.port == 0:  # to ask for it is to have it checked
        raise ValueError("must have a port from 1 to 65535, got 0")
    return url


def _bucket_url(url: str) -> str:
    """The address of an object store, for which there is a library."""
    parts = urlsplit(url)
    if url and (parts.scheme != "s3" or not parts.netloc or parts.query or parts.fragment):
        raise ValueError("must be s3://bucket or s3://bucket/prefix")
    if url and find_spec("boto3") is None:
        raise ValueError("needs boto3: install hockle[s3]")
    return url


def _sqlalchemy_url(url: str) -> str:
    """A PostgreSQL address as SQLAlchemy spells it, with the driver that is installed."""
    scheme, separator, rest = url.partition("://")
    if scheme in ("postgres", "postgresql"):
        url = f"postgresql+psycopg{separator}{rest}"
    elif url and scheme not in ("postgresql+psycopg", "sqlite"):
        raise ValueError(f"must be postgresql:// or sqlite://, got scheme {scheme!r}")
    try:
        if url and not make_url(url).database:
            raise ValueError("must name a database after the host, as postgresql://host/name")
    except ArgumentError:
        raise ValueError("must be an address, as postgresql://user@host:5432/name") from None
    return url


@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class Settings:
    """Where the service keeps things, how it shares them out, and its times in seconds."""

    data: Annotated[Path, means("what one host keeps: registry, locks, logs, messages")] = Path("var")
    database: Annotated[
        str, AfterValidator(_sqlalchemy_url), Field(repr=False),
        means("`postgresql://user@host/name`; needed for more than one host. Empty: SQLite in `HOCKLE_DATA`"),
    ] = ""  # fmt: skip
    broker: Annotated[
        str, AfterValidator(_kombu_url), Field(repr=False),
        means("a broker of your own: `redis://`, `rediss://` or `unix://`. Empty: `hockle serve` starts one, or "
              "messages lie as files"),
    ] = ""  # fmt: skip
    store: Annotated[
        Path | None, means("datasets and checkpoints; several hosts share it. None: in `HOCKLE_DATA`")
    ] = None
    objects: Annotated[
        str, AfterValidator(_bucket_url),
        means("`s3://bucket/prefix`: datasets are published there, as objects, in place of `HOCKLE_STORE`; needs "
              "`hockle[s3]`"),
    ] = ""  # fmt: skip
    lease: Annotated[
        float, Positive, means("time after which the job of a silent worker goes to another", "s")
    ] = 30.0
    attempts: Annotated[
        int, Positive, means("how often a job is tried whose worker is lost before it gets any farther")
    ] = 3
    checkpoint: Annotated[float, Positive, means("the most running that a lost worker may cost", "s")] = 10.0
    longest_run: Annotated[
        float, Positive, means("the most computing that a case may ask for, by its estimate", "s")
    ] = 86400.0
    overrun: Annotated[
        float, Positive,
        means("how many times its estimate a run may compute, and at least a minute, before it is ended by name"),
    ] = 20.0  # fmt: skip
    turn: Annotated[
        float, Positive, means("how long a job runs before it gives way, with a checkpoint, to one of an owner who has "
                               "fewer running", "s")
    ] = 30.0  # fmt: skip
    most_running: Annotated[
        Annotated[int, Positive] | None, means("the most jobs of one owner that run at the same time")
    ] = None
    quota: Annotated[int, Positive, means("the most unfinished jobs of one owner")] = 10_000
    quota_bytes: Annotated[
        Annotated[int, Positive] | None,
        means("the most bytes of datasets of one owner: beyond it nothing more is accepted", "bytes"),
    ] = None
    keep_days: Annotated[
        Annotated[float, Positive] | None, means("for how long a job is kept after its end; then it is deleted", "days")
    ] = None
    keep_bytes: Annotated[
        Annotated[int, Positive] | None,
        means("the most bytes of datasets that are kept of one owner: beyond it the oldest jobs are deleted", "bytes"),
    ] = None
    keep_free: Annotated[
        Annotated[int, Positive] | None,
        means("the least free disk: below it the oldest jobs are deleted", "bytes"),
    ] = None
    rate: Annotated[float, Positive, means("the most requests of one owner who has a key", "1/s")] = 100.0
    require_keys: Annotated[bool, means("ask for API keys on loopback too, as behind a proxy")] = False
    hosts: Annotated[str, means("names by which clients know the service, with commas between")] = ""
    log_bytes: Annotated[
        int, Positive,
        means("the largest that a log of `hockle serve` grows; four older ones are kept of each", "bytes"),
    ] = 50_000_000  # fmt: skip
    limit_wall: Annotated[float, Positive, means("the longest that one job may run", "s")] = Limits.wall
    limit_memory: Annotated[
        int, Field(ge=LEAST_MEMORY), means("the most memory that one job may use", "bytes")
    ] = Limits.memory
    limit_disk: Annotated[int, Positive, means("the most disk that one job may use", "bytes")] = Limits.disk

    @property
    def limits(self) -> Limits:
        """What a job may use that asks for no less."""
        return Limits(self.limit_wall, self.limit_memory, self.limit_disk)

    @property
    def database_url(self) -> str:
        """The registry's address for SQLAlchemy."""
        return self.database or f"sqlite:///{self.data.absolute() / 'registry.db'}"

    @property
    def datasets(self) -> Path:
        """The directory of the published datasets."""
        return (self.store or self.data) / "datasets"

    @property
    def copies(self) -> Path:
        """The directory of this host's copies of objects."""
        return self.data / "copies"

    @property
    def work(self) -> Path:
        """The directory of what unfinished jobs have reached: one directory each."""
        return (self.store or self.data) / "work"

    @property
    def locks(self) -> Path:
        """The directory of the lock files of this host."""
        return self.data / "locks"

    @property
    def messages(self) -> Path:
        """The directory of the messages when no broker process runs."""
        return self.data / "messages"

    @property
    def pulses(self) -> Path:
        """The directory of the files by which the processes of this host show that they get on."""
        return self.data / "pulses"

    def make_directories(self) -> None:
        """Make the data directory and what it holds, for this user only, as is all that this process makes from now on.

        Raises OSError that names a directory that cannot be made, written, or kept from others.
        """
        os.umask(0o077)
        for directory in (self.data, self.datasets, self.copies, self.work, self.locks, self.messages, self.pulses):
            directory.mkdir(mode=0o700, parents=True, exist_ok=True)
            if not os.access(directory, os.W_OK | os.X_OK):
                raise PermissionError(errno.EACCES, "this user cannot write there", str(directory.absolute()))
        _close(self.data)

    def environment(self) -> dict[str, str]:
        """The environment variables from which `from_environment` makes the same settings, without a file."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        values |= {name: path.absolute() for name, path in values.items() if isinstance(path, Path)}
        return {FILE: ""} | {variable(name): "" if value is None else str(value) for name, value in values.items()}


def _close(directory: Path) -> None:
    """Keep others from a directory that somebody made beforehand. Raises PermissionError."""
    open_to_others = directory.stat().st_mode & 0o077
    if not open_to_others:
        return
    try:
        directory.chmod(0o700)
    except PermissionError:
        raise PermissionError(errno.EPERM, "other users may enter it, and it is not this user's to close: chmod 700 it",
                              str(directory.absolute())) from None


def variable(field: str) -> str:
    """The environment variable of a setting."""
    return "REDIS_URL" if field == "broker" else f"HOCKLE_{field.upper()}"


def from_environment(environment: Mapping[str, str] = os.environ) -> Settings:
    """The settings of the file that HOCKLE_SETTINGS names, if any, with those of the environment over them.

    Raises ValueError with a line for each fault that names the setting, its value and the rule.
    """
    values: dict[str, Any] = {}
    if path := environment.get(FILE):
        values = _read(path)
    names = {field.name: variable(field.name) for field in fields(Settings)}
    values |= {name: environment[key] for name, key in names.items() if environment.get(key)}
    try:
        return TypeAdapter(Settings).validate_python(values)
    except ValidationError as error:
        raise ValueError("\n".join(_sentence(fault, names) for fault in error.errors())) from None


def _read(path: str) -> dict[str, Any]:
    try:
        return tomllib.loads(Path(path).read_text())
    except OSError as error:
        raise ValueError(f"{FILE}: must name a file that can be read, got {path!r}: {error.strerror}") from None
    except ValueError as error:
        raise ValueError(f"{FILE}: must name a file in TOML, got {path!r}: {error}") from None


def _sentence(fault: Any, names: Mapping[str, str]) -> str:
    """One fault. The value of an address is not shown, nor of what is no setting: it may hold a password."""
    name = str(fault["loc"][0])
    value = "" if name in ("database", "broker") or name not in names else f", got {fault['input']!r}"
    return f"{names.get(name, name)}: {fault['msg'].removeprefix('Value error, ')}{value}"
