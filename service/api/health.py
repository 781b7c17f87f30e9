"""How the parts of the service do, as one API process sees them: looked at again and again by threads of their own.

So whoever asks is answered at once, also where a look never ends: what was not seen for STALE seconds is unreachable.
"""

from __future__ import annotations

import asyncio
import logging
import shutil
import time
from collections.abc import AsyncIterator, Mapping
from contextlib import ExitStack, asynccontextmanager, suppress
from typing import Literal, Protocol, Self

from sqlalchemy.exc import DBAPIError, SQLAlchemyError

from service.jobs import Database
from service.jobs.doorbell import Doorbell
from service.jobs.leader import LEASE
from service.jobs.processes import EVERY, Presence, Roll
from service.jobs.sqlite import FilesReplaced
from service.pulse import EVERY as BEAT
from service.pulse import Pulse
from service.rounds import Rounds
from service.settings import Settings

STALE = 10.0
STUCK = 60.0
"""Seconds after which a thread of this process does not get on: it is started again with the process."""
LEAST_FREE = 50_000_000
"""Bytes of free disk, below which no job is sure to be kept."""

Reached = Literal["ok", "unreachable"]
Kept = Literal["ok", "unreachable", "replaced"]
Room = Literal["ok", "full"]
Workers = Literal["ok", "none", "silent"]
Led = Literal["ok", "none"]
log = logging.getLogger(__name__)


class Part(Protocol):
    """What gets on, or does not."""

    @property
    def silent(self) -> float:
        """Seconds since it last got on."""


class Health:
    """Of the service, as a context; and this process's part in it, which it writes to the registry every EVERY
    seconds: what can be written there shows that the database takes writes."""

    def __init__(self, database: Database, doorbell: Doorbell, settings: Settings, leader: Part,
                 parts: Mapping[str, Part]) -> None:
        """`parts`: the threads of this process, by name."""
        self._database, self._doorbell, self._settings = database, doorbell, settings
        self._leader, self._parts = leader, parts
        self._presence, self._roll = Presence(database, "api"), Roll()
        self._reached = {"database": -STALE, "broker": -STALE}
        """When each was last reached (time.monotonic)."""
        self._rounds = ExitStack()

    def __enter__(self) -> Self:
        self._look_at_database()  # the first answer shall be true; a broker that is away takes long
        for name, look in (("database", self._look_at_database), ("broker", self._look_at_broker)):
            self._rounds.enter_context(Rounds(f"looking at the {name}", EVERY, look))
        return self

    def __exit__(self, *_: object) -> None:
        self._rounds.close()
        with suppress(DBAPIError):
            self._presence.leave()

    @property
    def database(self) -> Kept:
        """Whether the registry is read and written, and its files are those that were opened."""
        try:
            self._database.check()
        except FilesReplaced:
            return "replaced"
        return self._state_of("database")

    @property
    def broker(self) -> Reached:
        """Whether workers can be rung."""
        return self._state_of("broker")

    @property
    def disk(self) -> Room:
        """Whether there is room for what jobs write."""
        return "ok" if shutil.disk_usage(self._settings.data).free >= LEAST_FREE else "full"

    @property
    def workers(self) -> Workers:
        """Whether there is a worker, and none that stands still."""
        if any(name.startswith("worker ") for name in self._roll.silent):
            return "silent"
        return "ok" if self._roll.workers else "none"

    @property
    def leader(self) -> Led:
        """Whether some process looks after lost jobs."""
        return "ok" if self._leader.silent < 2 * LEASE else "none"

    @property
    def silent(self) -> list[str]:
        """The processes, and parts of processes, that stand still or are lost."""
        return self._roll.silent

    @property
    def ages(self) -> dict[str, float]:
        """For how long (s) nothing was heard of each process, and of whoever leads."""
        return self._roll.ages | {"leader": self._leader.silent}

    @asynccontextmanager
    async def shown(self) -> AsyncIterator[None]:
        """While the block runs, the supervisor sees that this process gets on: its event loop, and, where it is not
        for the database, its threads."""
        pulse = Pulse(self._settings.pulses, "api")
        task = asyncio.create_task(self._beat(pulse))
        try:
            yield
        finally:
            task.cancel()
            pulse.end()

    async def _beat(self, pulse: Pulse) -> None:
        while True:
            if self.database != "ok" or not self._stuck():
                pulse.beat()
            await asyncio.sleep(BEAT)

    def _stuck(self) -> list[str]:
        return [name for name, part in self._parts.items() if part.silent > STUCK]

    def _state_of(self, name: str) -> Reached:
        return "ok" if time.monotonic() - self._reached[name] < STALE else "unreachable"

    def _look_at_database(self) -> None:
        try:
            self._presence.beat(self._stuck())
            self._roll.call(self._database)
        except SQLAlchemyError as error:
            log.warning("the database cannot be written: %s", error)
            self._reached["database"] = time.monotonic() - STALE
        else:
            self._reached["database"] = time.monotonic()

    def _look_at_broker(self) -> None:
        reached = self._doorbell.reachable()
        self._reached["broker"] = time.monotonic() - (0.0 if reached else STALE)
