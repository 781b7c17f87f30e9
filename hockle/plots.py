"""hockle plot: a dataset's figures, and the paper's milestones; several datasets beside each other."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hockle.failure import Failure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

PAPERS_CASE = "goyal-2003"
SHAPE = {"r", "orientation"}


def register(subparsers: Any) -> None:
    """Add `hockle plot`."""
    parser = subparsers.add_parser("plot", help="draw datasets: shapes, energies, twist and writhe")
    parser.add_argument("datasets", type=Path, nargs="+", metavar="OUT.nc", help="several are drawn beside each other")
    parser.add_argument("-o", "--output", type=Path, help="directory (default that of the first dataset)")
    parser.set_defaults(run=plot)


def plot(arguments: argparse.Namespace) -> int:
    """Draw datasets, print the milestones of one that is the paper's cable, and name the figures."""
    directory = arguments.output or arguments.datasets[0].parent
    directory.mkdir(parents=True, exist_ok=True)
    if len(arguments.datasets) > 1:
        print("\n".join(map(str, compare(arguments.datasets, directory))))
        return 0
    figures, rows = draw(arguments.datasets[0], directory), milestones_table(arguments.datasets[0])
    print("\n".join([rows, *map(str, figures)] if rows else map(str, figures)))
    return 0


def draw(path: Path, directory: Path) -> list[Path]:
    """Draw the dataset's figures into a directory: energies; snapshots if the shape is stored; topology if the rod is
    twisted at all.

    Raises Failure for a file that cannot be read, or one that lacks what a figure shows.
    """
    from hockle import figures

    with drawable(path) as dataset:
        drawings: dict[str, Callable[[xr.Dataset], Figure]] = {"energies": figures.energies}
        if set(dataset.data_vars) >= SHAPE:
            drawings["snapshots"] = figures.snapshots
        if dataset.Wr.notnull().any() and figures.is_twisted(dataset):
            drawings["topology"] = figures.topology
        return [
            _save(drawings[name](dataset), directory / f"{path.stem}-{name}.png") for name in sorted(drawings)
        ]


def compare(paths: list[Path], directory: Path) -> list[Path]:
    """Draw several datasets beside each other into a directory: curves, and the last shapes where all store them."""
    from hockle import comparison

    with several(paths) as datasets:
        figures = {"curves": comparison.curves(datasets)}
        if all(set(dataset.data_vars) >= SHAPE for dataset in datasets.values()):
            figures["shapes"] = comparison.shapes(datasets)
        return [_save(figure, directory / f"comparison-{name}.png") for name, figure in figures.items()]


@contextmanager
def several(paths: list[Path]) -> Iterator[dict[str, xr.Dataset]]:
    """Datasets by the names of their files, or by their paths where two have one name. Raises Failure."""
    from hockle.comparison import MOST

    if len(paths) > MOST:
        raise Failure(f"at most {MOST} datasets can be drawn beside each other, got {len(paths)}")
    unique = len({path.stem for path in paths}) == len(paths)
    with ExitStack() as stack:
        yield {path.stem if unique else str(path): stack.enter_context(drawable(path)) for path in paths}


@contextmanager
def drawable(path: Path) -> Iterator[xr.Dataset]:
    """A dataset of at least two frames. Raises Failure."""
    from service.results import open_dataset

    try:
        dataset = open_dataset(path)
    except OSError as error:
        raise Failure(f"{path} cannot be drawn: {error.strerror or error}") from None
    with dataset:
        if dataset.sizes["time"] < 2:
            raise Failure(f"{path} has {dataset.sizes['time']} frames: too few to draw")
        yield dataset


def milestones_table(path: Path) -> str:
    """The paper's milestones in this run beside the paper's own, as text; nothing for another case."""
    from hockle import milestones
    from service.results import open_dataset

    with open_dataset(path) as dataset:
        if dataset.attrs["case_name"] != PAPERS_CASE or dataset.sizes["time"] < 4:
            return ""
        if "orientation" not in dataset:
            return ""
        return milestones.table(milestones.milestones(dataset))


def _save(figure: Figure, path: Path) -> Path:
    try:
        figure.savefig(path, dpi=150)
    except OSError as error:
        raise Failure(f"{path} cannot be written: {error.strerror or error}") from None
    return path
