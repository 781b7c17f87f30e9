"""hockle film: a moving picture of one dataset, or of several on one clock."""

from __future__ import annotations

import argparse
import json
import shutil
from collections.abc import Mapping
from math import floor, log10
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hockle.failure import Failure
from hockle.plots import SHAPE, several

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.animation import AbstractMovieWriter

RATES = {".mp4": 25, ".gif": 12}
"""Pictures in a second, by the kind of file; one of a GIF takes much more room."""

DPI = {".mp4": 130, ".gif": 72}
LONGEST = 600.0


def register(subparsers: Any) -> None:
    """Add `hockle film`."""
    parser = subparsers.add_parser("film", help="make a film of a dataset, or of several on one clock")
    parser.add_argument("datasets", type=Path, nargs="+", metavar="OUT.nc")
    parser.add_argument("-o", "--output", type=Path, required=True, help="a file that ends in .mp4 or .gif")
    parser.add_argument("--seconds", type=float, default=10.0, help="how long the film lasts (default 10)")
    parser.set_defaults(run=film)


def film(arguments: argparse.Namespace) -> int:
    """Make the film, and name it."""
    kind = arguments.output.suffix.lower()
    if kind not in RATES:
        raise Failure(f"output must end in {' or '.join(RATES)}, got {arguments.output}")
    if not 0 < arguments.seconds <= LONGEST:
        raise Failure(f"seconds must be > 0 and <= {LONGEST:g}, got {arguments.seconds:g}")
    with several(arguments.datasets) as datasets:
        for name, dataset in datasets.items():
            if missing := SHAPE - set(dataset.data_vars):
                raise Failure(f"{name} holds no {' and no '.join(sorted(missing))}: output.fields must have them")
        try:
            many = make(datasets, arguments.output, arguments.seconds)
        except OSError as error:
            raise Failure(f"{arguments.output} cannot be written: {error.strerror or error}") from None
    print(f"{arguments.output} ({arguments.output.stat().st_size / 1e6:.1f} MB, {many} pictures)")
    return 0


def make(datasets: Mapping[str, xr.Dataset], path: Path, seconds: float) -> int:
    """Write a film of all the datasets' time; gives the number of its pictures. Raises OSError, Failure."""
    import numpy as np

    from hockle.stage import Stage
    from hockle.tube import Tube
    from hockle.view import View

    kind = path.suffix.lower()
    cases = [json.loads(dataset.attrs["case"]) for dataset in datasets.values()]
    views = [View.of(case, dataset.r.values) for case, dataset in zip(cases, datasets.values(), strict=True)]
    points = [dataset.r.values.reshape(-1, 3) @ view.axes.T
              for dataset, view in zip(datasets.values(), views, strict=True)]  # fmt: skip
    stage = Stage(cases, views, np.vstack(points))
    if len(datasets) == 1:
        stage.title(next(iter(datasets.values())).attrs["title"])
    end = max(float(dataset.time[-1]) for dataset in datasets.values())
    times = np.linspace(0.0, end, max(2, round(seconds * RATES[kind])))
    digits = max(0, 2 - floor(log10(end)))
    writer = _writer(kind)
    with writer.saving(stage.figure, str(path), DPI[kind]):
        for t in times:
            for i, ((name, dataset), view) in enumerate(zip(datasets.items(), views, strict=True)):
                label = f"{name}, " if len(datasets) > 1 else ""
                stage.draw(i, Tube.at(dataset, float(t)).turned(view.axes), f"{label}t = {t:.{digits}f} s")
            writer.grab_frame()
    return len(times)


def _writer(kind: str) -> AbstractMovieWriter:
    """What writes pictures into a file of that kind. Raises Failure where there is no ffmpeg for MP4."""
    import matplotlib as mpl
    from matplotlib.animation import FFMpegWriter, PillowWriter

    if kind == ".gif":
        return PillowWriter(fps=RATES[kind])
    mpl.rcParams["animation.ffmpeg_path"] = shutil.which("ffmpeg") or _carried()
    options = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p"]  # what all players show
    return FFMpegWriter(fps=RATES[kind], codec="libx264", bitrate=-1, extra_args=options)


def _carried() -> str:
    """The ffmpeg that comes with imageio-ffmpeg."""
    import imageio_ffmpeg

    try:
        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except RuntimeError:
        raise Failure("an MP4 needs ffmpeg, and there is none for this machine: install it, or write a .gif") from None
