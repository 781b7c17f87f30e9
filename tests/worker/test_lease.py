"""The lease is kept while a step takes long, and tells what the owner wants."""

from __future__ import annotations

from pathlib import Path

import pytest

from service.jobs import Job, NewJob, Registry
from worker.lease import Cancelled, Lease, LeaseLost

SECONDS = 0.2


@pytest.fixture
def registry(tmp_path: Path) -> Registry:
    return Registry(f"sqlite:///{tmp_path}/registry.db")


@pytest.fixture
def job(registry: Registry) -> Job:
    claim = registry.claim(registry.submit(NewJob({})).id, SECONDS, 3, "here")
    assert claim is not None
    return claim.job


def tell_until_refused(lease: Lease, until) -> None:
    until(lambda: lease.tell(0.5, 1.0))


def test_a_lease_is_renewed_without_any_frame(registry, job, until):
    with Lease(registry, job, SECONDS):
        until(lambda: registry.get(job.id).lease_until > job.lease_until + 2 * SECONDS)
    assert registry.get(job.id).epoch == job.epoch


def test_progress_reaches_the_row(registry, job, until):
    with Lease(registry, job, SECONDS) as lease:
        lease.tell(0.25, 8.5)
        until(lambda: registry.get(job.id).progress > 0)
    told = registry.get(job.id)
    assert (told.progress, told.t) == (0.25, 8.5)


def test_a_cancelled_job_stops_at_its_next_frame(registry, job, until):
    registry.cancel(job.id)
    with Lease(registry, job, SECONDS) as lease, pytest.raises(Cancelled):
        tell_until_refused(lease, until)


def test_a_job_that_is_anothers_stops_at_its_next_frame(registry, job, until):
    registry._clock = lambda: 1e12
    assert registry.claim(job.id, 1e6, 3, "elsewhere") is not None
    with Lease(registry, job, SECONDS) as lease, pytest.raises(LeaseLost):
        tell_until_refused(lease, until)


def test_a_database_that_is_away_for_a_moment_costs_nothing(registry, job, monkeypatch, until):
    renew, failures = Registry.renew, iter([OSError("away"), OSError("away")])

    def sometimes(self, *told):
        for failure in failures:
            raise failure
        return renew(self, *told)

    monkeypatch.setattr(Registry, "renew", sometimes)
    with Lease(registry, job, SECONDS) as lease:
        lease.tell(0.5, 1.0)
        until(lambda: registry.get(job.id).progress > 0)
