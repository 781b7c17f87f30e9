"""A short attack: what it finds it tells, and it finds nothing."""

from __future__ import annotations

import sys

import pytest

from chaos.attack import parsers
from chaos.attack.__main__ import serving
from chaos.attack.crowd import slowloris
from chaos.attack.requests import odd_requests
from chaos.attack.table import Row, text

SECONDS = 0.3


def test_every_parser_says_yes_or_the_no_that_is_promised():
    rows = parsers.parsers(1, SECONDS, 60.0)
    assert {row.what.removeprefix("parser: ") for row in rows} == set(parsers.PARSERS)
    assert [row for row in rows if not row.good] == []


def test_a_parser_that_breaks_is_told_with_its_seed(monkeypatch):
    def breaks(told: str) -> int:
        return len(told) // len(told.strip())

    monkeypatch.setattr(parsers, "PARSERS", {"broken": (breaks, parsers.TEXT, (ValueError,))})
    [row] = parsers.parsers(7, 60.0, 1.0)
    assert not row.good and row.seen.startswith("seed 7: ZeroDivisionError")


@pytest.mark.skipif(sys.platform != "linux", reason="looks at processes through /proc")
def test_odd_requests_are_refused_and_honest_clients_answered_beside_slow_ones():
    with serving() as (port, job_id):
        rows = odd_requests(port)
        crowd, _ = slowloris(port, job_id, slow=100, clients=10, seconds=3.0)
    assert [row for row in rows if row.seen.startswith(("2", "5"))] == []
    assert {row.what: row.seen.split()[0] for row in rows}["two Host headers"] == "400"
    assert int(crowd.seen.split()[-2]) >= 20  # each of the ten asks once a second


def test_the_table_marks_what_gave_way():
    told = text(["seed 1"], [Row("a", "b", "c", True), Row("d", "e", "f", False)])
    assert "| a | b | c | good |" in told and "| d | e | f | BAD |" in told and "- seed 1" in told


def test_parsers_end_in_time():
    seen = {row.seen for row in parsers.parsers(1, 60.0, 0.0)}
    assert seen == {"0 texts, seeds 1 to 0, 0 s of CPU"}
