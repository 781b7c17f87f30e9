"""A short faults campaign on each database: every job ends exactly once, as if nothing had happened."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from chaos.campaign import environment, run_seed
from chaos.cases import cases, undisturbed, with_halves
from chaos.faults.broker import double_messages, lose_message, wipe_broker
from chaos.faults.files import tear_checkpoint
from chaos.faults.processes import kill_at_rename, kill_child, stop_child_past_its_lease
from chaos.judge import judge
from chaos.postgres import binaries
from chaos.submitter import POISONED
from hockle.broker import redis_binary
from service.cases import apply_settings

JOBS, FAULTS = POISONED + 4, 4  # a few submissions are of two jobs
SHORT = {"short-loop": 4.0, "free-flight": 16.0}
KNOWN = with_halves({name: apply_settings(cases()[name], {"t_end": t_end}) for name, t_end in SHORT.items()})
STEPS_BETWEEN = 1000.0  # one of these jobs, on average
QUICK = (kill_child, stop_child_past_its_lease, wipe_broker, double_messages, lose_message, tear_checkpoint,
         kill_at_rename)  # fmt: skip

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="looks at processes through /proc"),
    pytest.mark.skipif(redis_binary() is None, reason="no Redis on this machine"),
]


@pytest.fixture(scope="module")
def expected() -> dict[str, str]:
    """The digests of undisturbed runs."""
    return {name: undisturbed(case) for name, case in KNOWN.items()}


@pytest.mark.parametrize("kind", [
    "sqlite",
    pytest.param("postgresql", marks=pytest.mark.skipif(binaries() is None, reason="no PostgreSQL on this machine")),
])  # fmt: skip
def test_every_job_ends_exactly_once_whatever_is_killed_lost_or_stopped(kind, expected, tmp_path: Path, monkeypatch):
    monkeypatch.setattr("chaos.campaign.STEPS_BETWEEN", STEPS_BETWEEN)
    with environment(kind, tmp_path / "data") as (settings, server, small):
        record, watch = run_seed(1, settings, server, small, KNOWN, JOBS, FAULTS, QUICK)
        verdict = judge(record, watch, settings, expected)
    assert record.all_ended
    assert verdict.jobs >= JOBS and verdict.published > 0
    assert record.ensembles and record.starved and record.poisoned and verdict.read_live > 0
    assert not any(verdict.bad), verdict
