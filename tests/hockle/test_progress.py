"""The progress bar: what it says, and how long it says is left."""

from __future__ import annotations

import pytest

from hockle.progress import Pace, show


def test_what_is_left_follows_from_progress_and_time():
    pace = Pace()
    assert pace.remaining(0.0, 100.0) is None
    assert pace.remaining(0.25, 110.0) == pytest.approx(30.0)
    assert pace.remaining(1.0, 140.0) == 0.0


def test_a_job_that_is_met_on_its_way_is_judged_by_what_is_seen_of_it():
    pace = Pace()
    assert pace.remaining(0.5, 0.0) is None
    assert pace.remaining(0.75, 10.0) == pytest.approx(10.0)


def test_the_phase_is_shown_where_there_is_one(capsys: pytest.CaptureFixture[str]):
    told = {"status": "elastica", "progress": 1.0, "t": 2.0}
    assert show([told | {"phase": "loading the solver"}]) == told | {"phase": "loading the solver"}
    assert "elastica: loading the solver" in capsys.readouterr().err
    show([told])
    assert "elastica:" not in capsys.readouterr().err
