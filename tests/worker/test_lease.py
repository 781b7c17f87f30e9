"""The lease is kept while a step takes long, tells what must end the run, and ends a process that lost it."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import pytest

from service.jobs import Limits, NewJob, Reached, Registry
from service.jobs.held import HeldJob, claim
from worker import lease as lease_module
from worker.lease import Cancelled, Lease, LeaseLost, OutOfTime

LONG = 1000.0  # the kernel ends this process after 3/4 of it


@pytest.fixture(autouse=True)
def quick_renewals(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lease_module, "RENEWAL", 0.01)


def held(registry: Registry, limits: Limits | None = None) -> HeldJob:
    taken = claim(registry.database, registry.submit(NewJob({}, limits=limits or Limits())).id, LONG, "here")
    assert taken is not None
    return taken


def kept(job: HeldJob) -> Lease:
    return Lease(job, LONG, time.monotonic())


def test_a_lease_is_renewed_without_any_step(registry, until):
    job = held(registry)
    with kept(job):
        until(lambda: registry.get(job.job.id).lease_until > job.job.lease_until)
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_the_kernel_is_told_to_end_the_process_before_the_lease_is_over(registry, until):
    with Lease(held(registry), LONG, since=time.monotonic() - 100.0):
        assert 0 < signal.getitimer(signal.ITIMER_REAL)[0] <= 0.75 * LONG - 100.0
        until(lambda: signal.getitimer(signal.ITIMER_REAL)[0] > 0.75 * LONG - 100.0, "a renewal puts it off")


def test_what_was_reached_comes_into_the_row_with_the_time_it_took(registry, until):
    job = held(registry)
    with kept(job) as lease:
        lease.tell(Reached(0.25, 8.5, steps=70))
        until(lambda: registry.get(job.job.id).reached.steps == 70)
    told = registry.get(job.job.id).reached
    assert (told.progress, told.t) == (0.25, 8.5)
    assert told.wall > 0


def test_a_cancelled_job_stops_at_its_next_step(registry, until):
    job = held(registry)
    registry.cancel(job.job.id)
    with kept(job) as lease, pytest.raises(Cancelled):
        until(lambda: lease.tell(Reached(0.5)))


def test_a_job_that_is_anothers_stops_at_its_next_step(registry, until):
    job = held(registry)
    job.release()
    with kept(job) as lease, pytest.raises(LeaseLost):
        until(lambda: lease.tell(Reached(0.5)))


def test_a_job_that_runs_for_too_long_stops_at_its_next_step(registry, until):
    with kept(held(registry, Limits(wall=0.05))) as lease, pytest.raises(OutOfTime):
        until(lambda: lease.tell(Reached(0.5)))


def test_a_database_that_is_away_for_a_moment_costs_nothing(registry, monkeypatch, until):
    renew, failures = HeldJob.renew, iter([OSError("away"), OSError("away")])

    def sometimes(self, *told):
        for failure in failures:
            raise failure
        return renew(self, *told)

    monkeypatch.setattr(HeldJob, "renew", sometimes)
    job = held(registry)
    with kept(job) as lease:
        lease.tell(Reached(0.5, 1.0, steps=1))
        until(lambda: registry.get(job.job.id).progress > 0)


STALLED = """
import sys, time
from service.jobs import Database, NewJob, Registry
from service.jobs.held import HeldJob, claim
from worker.lease import Lease

def away(*_):
    raise OSError("the database is away")

registry = Registry(Database(sys.argv[1]))
job = claim(registry.database, registry.submit(NewJob({})).id, 1.0, "here")
HeldJob.renew = away
with Lease(job, 1.0, time.monotonic()):
    time.sleep(60)
"""


def test_a_process_that_cannot_renew_its_lease_is_ended_by_the_kernel(tmp_path):
    ended = subprocess.run([sys.executable, "-c", STALLED, f"sqlite:///{tmp_path}/r.db"], capture_output=True)
    assert ended.returncode == -signal.SIGALRM
