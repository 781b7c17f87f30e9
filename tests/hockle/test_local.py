"""hockle run, cases, validate: what they print, leave behind, and return."""

from __future__ import annotations

import errno
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import service.cases
import solver
from hockle.cli import main
from hockle.parts import SINGLE_THREADED
from service.cases import apply_settings, estimate, load_case, parse_case
from service.results import durable, open_dataset
from solver import Frame, Outcome, RunFailed, Scene, Simulation

QUICK = ["--set", "t_end=0.5", "--set", "numerics.intervals=20", "--set", "output.interval=0.1"]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "out.nc"


def run(path: Path, *more: str) -> int:
    return main(["run", "elastica", "-o", str(path), *QUICK, *more])


def after_two_frames(monkeypatch: pytest.MonkeyPatch, happens: Callable[[], None]) -> None:
    """Let something happen once a simulation has given two frames."""

    class Interrupted(Simulation):
        def advance(self) -> Frame | None:
            if self._frames == 2:
                happens()
            return super().advance()

    def simulate(scene: Scene) -> Simulation:
        return Interrupted(scene)

    monkeypatch.setattr(solver, "simulate", simulate)


def test_a_run_writes_its_dataset_and_sums_it_up(path: Path, capsys: pytest.CaptureFixture[str]):
    assert run(path) == 0
    told = capsys.readouterr().out
    for word in ("elastica: completed", "steps", "CPU", "Tw", "Wr", "Lk", "balance", str(path)):
        assert word in told
    with open_dataset(path) as dataset:
        assert dataset.attrs["outcome"] == "completed"
        assert dataset.sizes == {"time": 6, "s": 21, "body": 3, "lab": 3, "quaternion": 4}


def test_a_static_run_tells_of_stability(path: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["run", "static-elastica", "-o", str(path), "--set", "numerics.intervals=20"]) == 0
    assert "parameter 10 s, stable" in capsys.readouterr().out
    with open_dataset(path) as dataset:
        assert dataset.negative_modes.values.tolist() == [0] * 11
        assert dataset.parameter.values.tolist() == pytest.approx(list(range(11)))
        assert np.isnan(dataset.energy_balance).all()


def test_the_dataset_is_named_after_the_case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "elastica", *QUICK]) == 0
    assert [file.name for file in tmp_path.iterdir()] == ["elastica.nc"]


def test_an_interrupted_run_says_so_and_leaves_nothing(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    def interrupt() -> None:
        raise KeyboardInterrupt

    after_two_frames(monkeypatch, interrupt)
    assert run(path) == 130
    assert f"interrupted, nothing was written to {path}" in capsys.readouterr().err
    assert list(path.parent.iterdir()) == []


def test_a_run_that_fails_keeps_its_frames_and_names_the_remedy(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    def fail() -> None:
        raise RunFailed(Outcome.ROD_CROSSED_ITSELF, 0.15, 7)

    after_two_frames(monkeypatch, fail)
    assert run(path) == 1
    assert "the rod passed through itself: use more intervals" in capsys.readouterr().err
    with open_dataset(path) as dataset:
        assert dataset.attrs["outcome"] == "rod_crossed_itself"
        assert "t = 0.15 s, step 7" in dataset.attrs["message"]
        assert dataset.sizes["time"] == 2


def test_a_full_disk_is_told_and_leaves_nothing(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as disk:
        disk.setattr(durable.os, "fsync", full)
        assert run(path) == 1
    assert f"the disk is full, nothing was written to {path}" in capsys.readouterr().err
    assert list(path.parent.iterdir()) == []


@pytest.mark.parametrize("where", ["no/such/directory/out.nc", "."])
def test_a_place_that_cannot_be_written_is_told(
    where: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "elastica", "-o", where, *QUICK]) == 1
    assert where in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["run", "validate"])
def test_a_bad_case_is_refused_with_every_fault(command: str, capsys: pytest.CaptureFixture[str]):
    faults = ["--set", "rod.length=-1", "--set", "t_end=soon"]
    assert main([command, "elastica", *faults]) == 1
    told = capsys.readouterr().err
    assert "/rod/length must be > 0, got -1" in told
    assert "/t_end must be a number, got 'soon'" in told


def test_validate_tells_the_size_of_a_case(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(load_case("goyal-2003")))
    assert main(["validate", str(path), "--set", "numerics.intervals=400"]) == 0
    size, likely = capsys.readouterr().out.split(";")
    assert size == "goyal-2003 is valid: 401 nodes, 341 frames, 680 steps or more"
    seconds, megabytes = (float(number) for number in re.findall(r"[\d.]+", likely))
    cost = estimate(parse_case(apply_settings(load_case("goyal-2003"), {"numerics.intervals": 400})))
    assert likely.endswith(" MB\n") and megabytes == pytest.approx(cost.bytes / 1e6, rel=0.05)
    assert seconds == pytest.approx(cost.seconds, rel=0.05)


def test_cases_lists_every_shipped_case(capsys: pytest.CaptureFixture[str]):
    assert main(["cases"]) == 0
    lines = capsys.readouterr().out.splitlines()
    titles = service.cases.shipped_cases()
    assert [line.split(maxsplit=1) for line in lines] == [[name, title] for name, title in titles.items()]


def test_a_local_command_does_not_load_the_registry():
    told = "import hockle.cli, sys; hockle.cli.main(['cases']); sys.exit('sqlalchemy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", told], stdout=subprocess.DEVNULL).returncode == 0


def test_a_command_computes_on_one_core():
    """Small matrices take twice the CPU time on two; numpy looks once, as it is imported."""
    unset = {name: value for name, value in os.environ.items() if name not in SINGLE_THREADED}
    program = ("import sys, hockle.cli; early = 'numpy' in sys.modules; hockle.cli.main(['cases']); import os; "
               "sys.exit(early or os.environ['OPENBLAS_NUM_THREADS'] != '1')")  # fmt: skip
    assert subprocess.run([sys.executable, "-c", program], env=unset, capture_output=True).returncode == 0


def test_validate_warns_of_a_slip_and_refuses_nothing(capsys: pytest.CaptureFixture[str]):
    assert main(["validate", "elastica", "--set", "rod.diameter=30"]) == 0
    assert "warning: /rod/diameter is more than 10 m, got 30.0: is it given in m?" in capsys.readouterr().err


def test_validate_looks_at_several_cases_and_says_of_which_it_speaks(capsys: pytest.CaptureFixture[str]):
    assert main(["validate", "elastica", "greenhil", "goyal-2003", "--set", "rod.diameter=30"]) == 1
    told = capsys.readouterr()
    assert [line.split()[0] for line in told.out.splitlines()] == ["elastica", "goyal-2003"]
    assert "elastica: warning: /rod/diameter is more than 10 m" in told.err
    assert "hockle: greenhil: the case must be a file that is there, or one of" in told.err


def test_a_shipped_case_and_the_schema_can_be_read(capsys: pytest.CaptureFixture[str]):
    assert main(["cases", "greenhill"]) == 0
    assert json.loads(capsys.readouterr().out) == load_case("greenhill")
    assert main(["cases", "grenhill"]) == 1
    assert "did you mean greenhill?" in capsys.readouterr().err
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == service.cases.case_schema()
