"""What stands on the terminal's line while jobs are waited for."""

from __future__ import annotations

from types import SimpleNamespace

from hockle_client import showing


def test_the_line_tells_the_seconds_that_are_left_once_they_can_be_known(monkeypatch, capsys):
    clock = iter([0.0, 1.0, 11.0, 21.0])
    monkeypatch.setattr(showing, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    line = showing.Line()
    for ended in (100, 150, 200):  # half of them had ended before
        line.show_many(ended, 200)
    assert [one.rstrip() for one in capsys.readouterr().err.split("\r")[1:]] == [
        "100 of 200 jobs have ended, 1 s", "150 of 200 jobs have ended, 11 s left", "200 of 200 jobs have ended, 21 s"]
