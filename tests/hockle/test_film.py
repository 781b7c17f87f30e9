"""hockle film: a moving picture of datasets."""

from __future__ import annotations

from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from hockle.cli import main
from hockle.tube import Tube
from service.cases import shipped_cases
from service.results import open_dataset

QUICK = ["--set", "t_end=4", "--set", "numerics.intervals=20", "--set", "output.interval=0.5"]


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("film") / "bent.nc"
    assert main(["run", "elastica", "-o", str(path), *QUICK]) == 0
    return path


def test_an_mp4_has_as_many_pictures_as_its_seconds_ask_for(path: Path, tmp_path: Path):
    film = tmp_path / "bent.mp4"
    assert main(["film", str(path), "-o", str(film), "--seconds", "0.4"]) == 0
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(film))
    assert frames == 10 and seconds == pytest.approx(0.4, abs=0.05)


def test_a_gif_of_two_datasets_moves(path: Path, tmp_path: Path):
    other = tmp_path / "other.nc"
    other.write_bytes(path.read_bytes())
    film = tmp_path / "both.gif"
    assert main(["film", str(path), str(other), "-o", str(film), "--seconds", "0.3"]) == 0
    with Image.open(film) as pictures:
        assert pictures.n_frames == 4
        first = np.asarray(pictures.convert("RGB"), float)
        pictures.seek(3)
        last = np.asarray(pictures.convert("RGB"), float)
    for half in (slice(0, first.shape[1] // 2), slice(first.shape[1] // 2, None)):
        assert np.abs(first[:, half] - last[:, half]).max() > 100


@pytest.mark.parametrize("name", shipped_cases())
def test_a_shipped_case_has_a_film_in_which_nothing_is_cut_off(name: str, tmp_path: Path):
    path, film = tmp_path / "out.nc", tmp_path / "film.gif"
    assert main(["run", name, "-o", str(path), *QUICK, "--set", "t_end=1"]) == 0
    assert main(["film", str(path), "-o", str(film), "--seconds", "0.2"]) == 0
    with Image.open(film) as pictures:
        assert pictures.n_frames == 2
        for k in range(2):
            pictures.seek(k)
            picture = np.asarray(pictures.convert("L"))
            edges = [picture[:2], picture[-2:], picture[:, :2], picture[:, -2:]]
            assert picture.min() < 100 and min(edge.min() for edge in edges) > 240


def test_between_frames_a_rod_is_between_them(path: Path):
    with open_dataset(path) as ds:
        r = ds.r.values
        tube = Tube.at(ds, 2.25)
        assert tube.r == pytest.approx((r[4] + r[5]) / 2)
        assert np.linalg.norm(tube.a1, axis=1) == pytest.approx(1.0)
        assert Tube.at(ds, 99.0).r == pytest.approx(r[-1])


@pytest.mark.parametrize(("arguments", "told"), [
    (["-o", "film.avi"], "output must end in .mp4 or .gif, got film.avi"),
    (["-o", "film.gif", "--seconds", "0"], "seconds must be > 0 and <= 600, got 0"),
    (["-o", "no/such/place/film.gif"], "cannot be written"),
])  # fmt: skip
def test_a_film_that_cannot_be_made_is_refused(
    path: Path, arguments: list[str], told: str, capsys: pytest.CaptureFixture[str]
):
    assert main(["film", str(path), *arguments]) == 1
    assert told in capsys.readouterr().err


def test_a_dataset_without_axes_has_no_film(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / "out.nc"
    assert main(["run", "elastica", "-o", str(path), *QUICK, "--set", 'output.fields=["r"]']) == 0
    assert main(["film", str(path), "-o", str(tmp_path / "film.gif")]) == 1
    assert "holds no orientation" in capsys.readouterr().err
