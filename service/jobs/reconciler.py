"""Looks after jobs that nobody else does: takes back the lost, ends the hopeless, rings for the waiting."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field

from sqlalchemy import func, select, update
from sqlalchemy.exc import DBAPIError

from outcomes import Outcome
from service.jobs.database import Database
from service.jobs.doorbell import Doorbell
from service.jobs.leader import Deposed, Leader
from service.jobs.lifecycle import Status
from service.jobs.pauses import drain
from service.jobs.processes import forget_lost
from service.jobs.sharing import make_room
from service.jobs.tables import jobs, owners, processes
from service.rounds import Rounds
from service.settings import Settings

LOOK = 1.5
"""Seconds between two looks, at the most: a leader renews its lease by each."""
AT_ONCE = 64
"""The most messages that are left for the workers: each makes one of them look for a job."""
TIDY = 60.0
"""Seconds after which a worker is rung though no job waits: it first removes what lost ones have left. As often owners'
unfinished jobs are counted."""

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Beat:
    """What a worker renews: as long as it changes, the worker lives."""

    job_id: str
    epoch: int
    lease_until: float


@dataclass
class Watch:
    """Tells lost leases from living ones.

    A lease is lost when this process has seen it unchanged for as long as it holds, by a clock that
    nobody can set. So neither a wrong clock nor one that jumps takes a job from a living worker.
    """

    lease: float
    clock: Callable[[], float] = time.monotonic
    _first_seen: dict[Beat, float] = field(default_factory=dict)

    def lost(self, beats: list[Beat]) -> list[Beat]:
        """Those of the beats there are now that have been the same for too long."""
        now = self.clock()
        self._first_seen = {beat: self._first_seen.get(beat, now) for beat in beats}
        return [beat for beat, since in self._first_seen.items() if now - since > self.lease]


def beats(database: Database) -> list[Beat]:
    """Those of all running jobs."""
    query = select(jobs.c.id, jobs.c.epoch, jobs.c.lease_until).where(jobs.c.status == Status.RUNNING)
    with database.reading() as connection:
        return [Beat(*row) for row in connection.execute(query)]


def take_back(database: Database | Leader, lost: Beat, attempts: int) -> None:
    """Take a job from a worker that has fallen silent: it waits again, or ends if that has no use.

    A renewal in the last moment is stronger; afterwards the epoch shuts the worker out.
    """
    same = (jobs.c.id == lost.job_id, jobs.c.epoch == lost.epoch, jobs.c.lease_until == lost.lease_until)
    hopeless = (f"its worker stopped answering {attempts} times without a new checkpoint: "
                f"{Outcome.WORKER_LOST.remedy}")
    with database.writing() as transaction:
        (
            transaction.change(*same, jobs.c.cancel_requested, event="ended", status=Status.DISMISSED,
                               epoch=jobs.c.epoch + 1, outcome=Outcome.CANCELLED.value,
                               message="cancelled; its worker had stopped answering")
            or transaction.change(*same, jobs.c.fruitless >= attempts, event="ended", status=Status.FAILED,
                                  epoch=jobs.c.epoch + 1, outcome=Outcome.WORKER_LOST.value, message=hopeless)
            or transaction.change(*same, event="taken_back", status=Status.ACCEPTED, epoch=jobs.c.epoch + 1, worker="")
        )  # fmt: skip


def dismiss_cancelled(database: Database | Leader) -> None:
    """End the waiting jobs whose cancelling met a worker that handed them back. There is hardly ever one: no writer
    waits while all that wait are looked through."""
    cancelled = jobs.c.status == Status.ACCEPTED, jobs.c.cancel_requested
    with database.reading() as connection:
        cancelled_ids = connection.scalars(select(jobs.c.id).where(*cancelled)).all()
    if not cancelled_ids:
        return
    with database.writing() as transaction:
        transaction.change(jobs.c.id.in_(cancelled_ids), *cancelled, event="ended", status=Status.DISMISSED,
                           outcome=Outcome.CANCELLED.value, message="cancelled while it waited")


def recount(database: Database | Leader) -> None:
    """Set right how many unfinished jobs and how many bytes owners have: a process of an older version, which does not
    keep the numbers, may have run beside this one."""
    of_owner = jobs.c.owner == owners.c.name
    unfinished = (
        select(func.count()).where(of_owner, jobs.c.status.in_((Status.ACCEPTED, Status.RUNNING))).scalar_subquery()
    )
    bytes_ = select(func.coalesce(func.sum(jobs.c.dataset_bytes), 0)).where(of_owner).scalar_subquery()
    miscounted = (owners.c.unfinished != unfinished) | (owners.c.bytes != bytes_)
    with database.reading() as connection:
        wrong = connection.scalars(select(owners.c.name).where(miscounted)).all()
    if not wrong:
        return
    of_wrong = owners.c.name.in_(wrong)
    with database.writing() as transaction:
        # held first, in one order, and counted after: what another transaction changes meanwhile it adds itself
        transaction.connection.execute(select(owners.c.name).where(of_wrong).order_by(owners.c.name).with_for_update())
        transaction.connection.execute(update(owners).where(of_wrong).values(unfinished=unfinished, bytes=bytes_))


def wanted(database: Database) -> int:
    """How many workers should look for a job: as many as jobs wait, of those that there are, up to AT_ONCE."""
    accepted = select(jobs.c.id).where(jobs.c.status == Status.ACCEPTED).limit(AT_ONCE).subquery()
    workers = select(func.count()).select_from(processes).where(processes.c.kind == "worker").scalar_subquery()
    with database.reading() as connection:
        waiting, there = connection.execute(select(func.count(), workers).select_from(accepted)).one()
    return int(min(waiting, max(there, 1)))  # the first worker may not be there yet


def ring_for_all(database: Database, doorbell: Doorbell, least: int = 0) -> None:
    """Have a message lie for each worker that should look for a job, and `least` in any case."""
    if messages := max(wanted(database), least):
        doorbell.leave(messages)


class Reconciler:
    """Reconciles a few times within each lease, while no other process does; with `rounds`, in a thread.

    Who does not lead watches the leases all the same: so a job that was lost with its leader is taken back as soon.
    """

    def __init__(self, database: Database, doorbell: Doorbell, settings: Settings) -> None:
        self._database, self._doorbell, self._attempts = database, doorbell, settings.attempts
        self._turn, self._most = settings.turn, settings.most_running
        self._watch = Watch(settings.lease)
        self.leader = Leader(database)
        self._interval = min(LOOK, settings.lease / 3)
        self._tidy_at = time.monotonic()

    @contextmanager
    def rounds(self) -> Iterator[Rounds]:
        """The thread, running."""
        with Rounds("reconciler", self._interval, self.once) as thread:
            yield thread
        with suppress(DBAPIError):  # then another sees that the lease is over
            self.leader.resign()

    def once(self) -> None:
        """Do what is due, if this process leads."""
        lost = self._watch.lost(beats(self._database))
        if not self.leader.elected():
            return
        try:
            self._lead(lost)
        except Deposed:
            log.warning("another process reconciles by now")

    def _lead(self, lost: list[Beat]) -> None:
        for beat in lost:
            log.warning("job %s, epoch %d: its worker has fallen silent", beat.job_id, beat.epoch)
            take_back(self.leader, beat, self._attempts)
        dismiss_cancelled(self.leader)
        drain(self.leader)
        make_room(self.leader, self._turn, self._most, time.time())
        tidy = time.monotonic() >= self._tidy_at
        ring_for_all(self._database, self._doorbell, least=int(tidy))
        if tidy:
            recount(self.leader)
            forget_lost(self.leader)
            self._tidy_at = time.monotonic() + TIDY
