"""What grows is told, processes and disk alike."""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import SimpleNamespace

import pytest

from chaos.growth import Growth, _size


@pytest.mark.parametrize(("sizes", "flat"), [([1.0, 5.0, 5.0, 5.4], True), ([1.0, 5.0, 5.0, 5.6], False)])
def test_a_disk_that_grows_is_told(sizes, flat):
    growth = Growth(SimpleNamespace(), {("worker", 1): [(300.0, 9, 1)] * 4}, sizes)
    assert growth.flat is flat
    assert growth.lines()[-1] == f"| disk | 4 | 5.0 | {sizes[-1]:.1f} |  |  | {'flat' if flat else 'GROWS'} |"


def test_every_sample_is_kept():
    growth = Growth(SimpleNamespace(), {("worker", 1): [(300.0, 9, 1), (301.5, 9, 2)]}, [1.0, 2.0])
    assert json.loads(growth.as_json()) == [["worker", [[300.0, 9, 1], [301.5, 9, 2]]], ["disk", [1.0, 2.0]]]


def test_a_folder_that_is_removed_while_it_is_looked_at_is_passed_over(tmp_path, monkeypatch):
    """It ended a soak after an hour."""
    (tmp_path / "kept").write_bytes(b"x" * 2000)
    (tmp_path / "removed").mkdir()
    scandir = os.scandir

    def looking(path):
        if Path(path).name == "removed":
            raise FileNotFoundError(path)
        return scandir(path)

    monkeypatch.setattr("os.scandir", looking)
    assert _size(tmp_path) == 0.002
