"""hockle plot: the figures of any dataset."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hockle.cli import main
from hockle.tube import Tube

QUICK = ["--set", "t_end=0.5", "--set", "numerics.intervals=20", "--set", "output.interval=0.1"]
PNG = b"\x89PNG\r\n"


def dataset(tmp_path: Path, *settings: str) -> Path:
    path = tmp_path / "out.nc"
    more = [word for setting in settings for word in ("--set", setting)]
    assert main(["run", "goyal-2003", "-o", str(path), *QUICK, *more]) == 0
    return path


def test_a_dataset_is_drawn_into_three_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = dataset(tmp_path)
    capsys.readouterr()
    assert main(["plot", str(path), "-o", str(tmp_path / "figures")]) == 0
    told = capsys.readouterr().out
    for name in ("snapshots", "energies", "topology"):
        figure = tmp_path / "figures" / f"out-{name}.png"
        assert figure.read_bytes().startswith(PNG)
        assert str(figure) in told
    assert "buckling (s)" in told


def test_what_was_not_stored_is_not_drawn(tmp_path: Path):
    path = dataset(tmp_path, 'output.fields=["r"]', "output.topology=false")
    assert main(["plot", str(path)]) == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == ["out-energies.png", "out.nc"]


@pytest.mark.parametrize("content", [None, b"no dataset at all"])
def test_a_file_that_is_no_dataset_is_told(
    tmp_path: Path, content: bytes | None, capsys: pytest.CaptureFixture[str]
):
    path = tmp_path / "out.nc"
    if content:
        path.write_bytes(content)
    assert main(["plot", str(path)]) == 1
    assert f"{path} cannot be drawn" in capsys.readouterr().err


def test_a_tubes_facets_lie_at_its_radius_and_its_stripe_along_a1():
    z = np.linspace(0.0, 1.0, 5)
    straight = np.column_stack([0 * z, 0 * z, z])
    tube = Tube.of(straight, np.tile([1.0, 0.0, 0.0, 0.0], (5, 1)))
    quads, colours = tube.facets(0.1)
    assert np.hypot(quads[..., 0], quads[..., 1]) == pytest.approx(0.1)
    centre = quads.mean(axis=1)
    angle = np.arctan2(centre[:, 1], centre[:, 0]) % (2 * np.pi)
    blue = colours[:, 2] > colours[:, 0]
    assert blue.tolist() == (angle < np.pi / 2).tolist()
