"""What became of every job of a seed, read from the database and the datasets afterwards."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, fields

from sqlalchemy import func, select

from chaos.cases import digest
from chaos.record import Record
from chaos.watch import Watch
from outcomes import Outcome
from service.jobs import ENDED, Database, Job, Registry, Status
from service.jobs.ensembles import Ensembles
from service.jobs.registry import Selection
from service.jobs.tables import events, jobs, owners
from service.settings import Settings

MOST_REDONE = 0.10


@dataclass
class Verdict:
    """Counts over jobs. All but the first six and the steps must be zero."""

    jobs: int = 0
    faults: int = 0
    published: int = 0
    deleted: int = 0
    looks: int = 0
    read_live: int = 0
    lost: int = 0
    duplicated: int = 0
    overlaps: int = 0
    not_identical: int = 0
    not_as_read: int = 0
    wrong_outcome: int = 0
    left_over: int = 0
    miscounted: int = 0
    steps: int = 0
    steps_redone: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)

    @property
    def redone(self) -> float:
        """The part of the steps that was computed again."""
        return self.steps_redone / max(self.steps, 1)

    @property
    def bad(self) -> tuple[int, ...]:
        """All that must be zero."""
        return (self.lost, self.duplicated, self.overlaps, self.not_identical, self.not_as_read,
                self.wrong_outcome, self.left_over, self.miscounted)  # fmt: skip

    @property
    def good(self) -> bool:
        """Whether all that must be zero is, and little was computed again."""
        return not any(self.bad) and self.redone < MOST_REDONE

    def __add__(self, other: Verdict) -> Verdict:
        return Verdict(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))


def judge(record: Record, watch: Watch, settings: Settings, expected: Mapping[str, str]) -> Verdict:
    """The verdict on one seed; `expected` are the digests of undisturbed runs by the name of their case."""
    database = Database(settings.database_url)
    by_id = {job.id: job for job in _all_jobs(Registry(database))}
    verdict = Verdict(jobs=len(by_id), faults=record.done, overlaps=watch.overlaps, looks=watch.looks)
    deleted = _deleted(database)
    verdict.deleted = len(deleted)
    verdict.lost = sum(job_id not in by_id and job_id not in deleted for job_id in record.accepted)
    ensembles = Ensembles(database)
    verdict.lost += sum(not ensembles.standing(ensemble_id).ended for ensemble_id in record.ensembles)
    ends, submitted = _ends(database), Counter((job.label, job.case_sha256) for job in by_id.values())
    for job in by_id.values():
        verdict.lost += job.status not in ENDED
        verdict.duplicated += ends.get(job.id, 0) > 1 or submitted[job.label, job.case_sha256] > 1
        verdict.steps += job.reached.steps
        verdict.steps_redone += job.reached.steps_redone
        verdict.outcomes[job.outcome] += 1
        if not _explained(job, record):
            verdict.wrong_outcome += 1
            print(f"wrongly ended: {job.label}, {job.outcome}: {job.message or 'no message'}", file=sys.stderr)
        if job.status is Status.SUCCESSFUL and job.dataset is not None:
            verdict.published += 1
            name = record.accepted.get(job.id)
            actual = digest(settings.datasets / job.dataset.file)
            reads = [read for read in record.reads if read.job == job.id]
            verdict.read_live += len(reads)
            verdict.not_as_read += sum(not read.is_of(settings.datasets / job.dataset.file) for read in reads)
            verdict.not_identical += actual not in ([expected[name]] if name else expected.values())
    files = {job.dataset.file for job in by_id.values() if job.dataset}
    verdict.left_over = len({path.name for path in settings.datasets.iterdir()} ^ files)
    verdict.miscounted = _miscounted(database)
    database.close()
    return verdict


def _explained(job: Job, record: Record) -> bool:
    """Whether the job may have ended so, after what was done."""
    if job.cancel_requested:
        return job.status is Status.DISMISSED
    if job.outcome == Outcome.WORKER_LOST:
        return job.fruitless >= 3
    if job.id in record.starved:
        return job.outcome == Outcome.OUT_OF_MEMORY
    return job.outcome == Outcome.COMPLETED


def _all_jobs(registry: Registry) -> list[Job]:
    page = registry.page(200)
    listed = page.jobs
    while page.next is not None:
        page = registry.page(200, Selection(after=page.next))
        listed += page.jobs
    return listed


def _deleted(database: Database) -> set[str]:
    """The jobs that retention has deleted: they had ended."""
    with database.reading() as connection:
        return set(connection.scalars(select(jobs.c.id).where(jobs.c.deleted.is_not(None))))


def _ends(database: Database) -> dict[str, int]:
    ended = select(events.c.job_id, func.count().label("number")).where(events.c.kind == "ended")
    with database.reading() as connection:
        return {row.job_id: row.number for row in connection.execute(ended.group_by(events.c.job_id))}


def _miscounted(database: Database) -> int:
    """How many owners' unfinished jobs are not as many as the registry remembers."""
    there_are = select(func.count()).where(jobs.c.owner == owners.c.name, jobs.c.status.not_in(ENDED)).scalar_subquery()
    with database.reading() as connection:
        return connection.scalar(select(func.count()).where(owners.c.unfinished != there_are)) or 0
