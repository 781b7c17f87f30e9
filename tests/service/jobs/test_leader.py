"""One process of many leads, another one when it stands still; and one that was deposed writes nothing."""

from __future__ import annotations

import pytest

from service.jobs import Database, NewJob, Registry, Status
from service.jobs.held import claim
from service.jobs.leader import LEASE, Deposed, Leader
from service.jobs.reconciler import Reconciler, beats, take_back
from service.settings import Settings


class Monotonic:
    """A clock that goes when it is told to."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def monotonic() -> Monotonic:
    return Monotonic()


@pytest.fixture
def two(database: Database, monotonic: Monotonic) -> tuple[Leader, Leader]:
    """Two claims to lead, of which the first one leads."""
    first, second = Leader(database, monotonic), Leader(database, monotonic)
    assert first.elected()
    assert not second.elected()
    return first, second


def test_who_leads_goes_on_while_it_renews(two, monotonic):
    first, second = two
    for _ in range(10):
        monotonic.now += 0.9 * LEASE
        assert first.elected()
        assert not second.elected()


def test_another_leads_when_the_lease_was_seen_unchanged_for_its_whole_length(two, monotonic):
    first, second = two
    monotonic.now += 0.9 * LEASE
    assert not second.elected()
    monotonic.now += 0.2 * LEASE
    assert second.elected()
    assert not first.elected()


def test_another_leads_at_once_when_the_first_resigns(two):
    first, second = two
    first.resign()
    assert second.elected()
    second.resign()


def test_only_one_takes_a_lease_that_is_over(database, monotonic):
    claims = [Leader(database, monotonic) for _ in range(5)]
    assert [claim.elected() for claim in claims].count(True) == 1
    monotonic.now += 2 * LEASE
    assert [claim.elected() for claim in claims].count(True) == 1


def test_who_was_deposed_while_it_stood_still_writes_nothing(two, monotonic, registry):
    """As a leader that is stopped after it has looked for the lost, and goes on when another one leads."""
    first, second = two
    job = claim(registry.database, registry.submit(NewJob({})).id, 10.0, "here")
    [beat] = beats(first)
    monotonic.now += 2 * LEASE
    assert second.elected()
    with pytest.raises(Deposed):
        take_back(first, beat, 3)
    assert registry.get(job.job.id).status is Status.RUNNING
    take_back(second, beat, 3)
    assert registry.get(job.job.id).status is Status.ACCEPTED


def test_who_does_not_lead_watches_the_leases_and_takes_a_lost_job_back_as_soon_as_it_does(
    registry: Registry, monotonic, tmp_path
):
    class Bell:
        def leave(self, wanted: int) -> None:
            pass

    lead = Leader(registry.database, monotonic)
    assert lead.elected()
    waits = Reconciler(registry.database, Bell(), Settings(data=tmp_path, lease=1e-9))
    job = claim(registry.database, registry.submit(NewJob({})).id, 10.0, "here")
    waits.once()
    assert registry.get(job.job.id).status is Status.RUNNING
    lead.resign()
    waits.once()
    assert registry.get(job.job.id).status is Status.ACCEPTED
