"""hockle plot: the figures of any dataset, and of several beside each other."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from hockle import figures
from hockle.cli import main
from hockle.stage import Stage
from hockle.tube import Tube
from hockle.view import View
from service.results import open_dataset

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


def test_what_is_not_twisted_has_no_figure_of_its_twist(tmp_path: Path):
    path = tmp_path / "out.nc"
    assert main(["run", "cantilever-vibration", "-o", str(path), *QUICK]) == 0
    assert main(["plot", str(path)]) == 0
    assert not (tmp_path / "out-topology.png").exists()
    assert (tmp_path / "out-snapshots.png").exists()


def test_what_hardly_changes_is_drawn_with_its_zero(tmp_path: Path):
    path = tmp_path / "out.nc"
    assert main(["run", "greenhill", "-o", str(path), "--set", "t_end=2", "--set", "numerics.intervals=20"]) == 0
    with open_dataset(path) as dataset:
        [axes] = figures.energies(dataset).axes
        [curve] = axes.lines
        assert np.ptp(curve.get_ydata()) < 1e-3 * curve.get_ydata().max()
        assert axes.get_ylim()[0] == 0.0


def test_what_a_rod_that_stretches_stores_is_drawn(tmp_path: Path):
    path = tmp_path / "out.nc"
    pulled = ["numerics.method=staggered", "rod.axial_stiffness=20000", 'ends.end={"preset": "free", "f3": 50}']
    settings = [word for setting in pulled for word in ("--set", setting)]
    assert main(["run", "cantilever-vibration", "-o", str(path), *QUICK, *settings]) == 0
    with open_dataset(path) as dataset:
        assert "stretching" in figures.energies(dataset).axes[0].get_legend_handles_labels()[1]


def test_what_is_thrown_without_twist_has_no_figure_of_its_twist(tmp_path: Path):
    path = tmp_path / "out.nc"
    assert main(["run", "free-flight", "-o", str(path), "--set", "t_end=1"]) == 0
    assert main(["plot", str(path)]) == 0
    assert not (tmp_path / "out-topology.png").exists()


def test_what_stays_as_it_is_is_shown_at_first_and_at_last(tmp_path: Path):
    path = tmp_path / "out.nc"
    assert main(["run", "greenhill", "-o", str(path), "--set", "t_end=2", "--set", "numerics.intervals=20"]) == 0
    with open_dataset(path) as dataset:
        assert list(figures.snapshot_times(dataset)) == [0.0, 2.0]


@pytest.mark.parametrize(("radius", "drawn", "told"), [(1e-4, 0.005, True), (0.02, 0.02, False)])
def test_a_rod_is_drawn_no_thinner_than_it_is(radius: float, drawn: float, told: bool, monkeypatch):
    asked = []
    facets = Tube.facets
    monkeypatch.setattr(Tube, "facets", lambda tube, thick: asked.append(thick) or facets(tube, thick))
    upright = np.array([[0.0, 0, 0], [0, 0, 1]])
    stage = Stage([{"rod": {"diameter": 2 * radius}}], [View(np.eye(3), "")], upright)
    stage.draw(0, Tube.of(upright, np.tile([1.0, 0.0, 0.0, 0.0], (2, 1))), "")
    assert asked == [pytest.approx(drawn)]
    assert any("thicker than the rod" in text.get_text() for text in stage.figure.texts) == told


BAR = {"start": [-0.05, -1.0, 0.6], "end": [-0.05, 1.0, 0.6], "radius": 0.03, "stiffness": 1e3}
FLOOR = {"stiffness": 1e3, "normal": [1.0, 0.0, 0.0], "height": -0.3}


def test_obstacles_and_a_floor_are_drawn_where_they_lie_on_each_panel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "out.nc"
    more = {"t_end": 1.0, "numerics.intervals": 20, "loads.gravity": "[-9.81, 0, 0]", "loads.point": "[]",
            "loads.obstacles": json.dumps([BAR]), "loads.floor": json.dumps(FLOOR)}  # fmt: skip
    assert main(["run", "elastica", "-o", str(path), *(f"--set={key}={value}" for key, value in more.items())]) == 0
    faces = []

    def collection(quads, **more):
        faces.append(np.array(quads))
        return Poly3DCollection(quads, **more)

    monkeypatch.setattr("hockle.stage.Poly3DCollection", collection)
    with open_dataset(path) as dataset:
        figure = figures.snapshots(dataset)
        axes = View.of(json.loads(dataset.attrs["case"]), dataset.r.values).axes
    assert len(faces) == len(figure.axes) >= 2
    for quads, panel in zip(faces, figure.axes, strict=True):
        places = quads @ axes  # in the lab
        across = np.hypot(places[..., 0] + 0.05, places[..., 2] - 0.6)
        bar = (np.abs(across - 0.03) < 1e-9).all(axis=1)
        assert bar.sum() > 300 and np.abs(places[bar][..., 1]).max() < 1.0  # it is 2 m long
        heights = [np.array(line.get_data_3d())[2] for line in panel.lines]
        assert sum(bool(np.allclose(height, -0.3)) for height in heights) > 10  # the grid; and the shadow
    caption = " ".join(text.get_text().replace("\n", " ") for text in figure.texts)
    assert "floor brown, obstacles grey" in caption


def test_several_datasets_are_drawn_beside_each_other(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    first = dataset(tmp_path).rename(tmp_path / "first.nc")
    second = dataset(tmp_path, "t_end=0.3").rename(tmp_path / "second.nc")
    capsys.readouterr()
    assert main(["plot", str(first), str(second), "-o", str(tmp_path / "figures")]) == 0
    told = capsys.readouterr().out
    for name in ("curves", "shapes"):
        figure = tmp_path / "figures" / f"comparison-{name}.png"
        assert figure.read_bytes().startswith(PNG)
        assert str(figure) in told
    assert main(["plot", *[str(first)] * 7]) == 1
    assert "at most 6 datasets" in capsys.readouterr().err


HANGING = np.array([[[0.0, 0, 0], [0, 0, 1]], [[0, 0, 0], [-0.3, 0, 0.9]]])


def test_gravity_is_down_and_a_horizontal_rod_lies():
    view = View.of({"loads": {"gravity": [-9.81, 0, 0]}}, HANGING)
    assert view.axes == pytest.approx(np.array([[0, 0, 1], [0, -1, 0], [1, 0, 0]]))
    assert view.directions == "e3 to the right, gravity -e1 down"
    start, end = HANGING[1] @ view.axes.T
    assert end[0] - start[0] == pytest.approx(0.9) and end[2] - start[2] == pytest.approx(-0.3)


def test_without_gravity_a_rod_along_e3_lies_as_in_the_paper_and_another_has_e3_up():
    assert View.of({}, HANGING).directions == "e3 to the right, e1 down"
    assert View.of({}, HANGING[..., ::-1]).directions == "e1 to the right, -e3 down"


@pytest.mark.parametrize("gravity", [(0, 0, -9.81), (1.0, 2.0, 3.0), (0, 9.81, 0)])
def test_a_view_is_a_rotation_with_gravity_along_its_last_axis(gravity: tuple[float, ...]):
    axes = View.of({"loads": {"gravity": gravity}}, HANGING).axes
    assert axes @ axes.T == pytest.approx(np.eye(3)) and np.linalg.det(axes) == pytest.approx(1.0)
    assert axes @ np.array(gravity) == pytest.approx([0, 0, -np.linalg.norm(gravity)])


def test_snapshots_are_taken_where_the_shapes_differ(tmp_path: Path):
    path = tmp_path / "out.nc"
    assert main(["run", "elastica", "-o", str(path), "--set", "numerics.intervals=20"]) == 0
    with open_dataset(path) as ds:
        times = figures.snapshot_times(ds)
        tips = ds.r.isel(s=-1).sel(time=times).values
    gaps = np.linalg.norm(np.diff(tips, axis=0), axis=1)
    assert len(times) == 4 and times[0] == 0.0
    assert gaps.min() > 0.1  # m; three of four even times show it at rest already


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
