"""hockle plot: a dataset's figures, and the paper's milestones."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from hockle.failure import Failure

PAPERS_CASE = "goyal-2003"


def register(subparsers: Any) -> None:
    """Add `hockle plot`."""
    parser = subparsers.add_parser("plot", help="draw a dataset: shapes, energies, twist and writhe")
    parser.add_argument("dataset", type=Path, metavar="OUT.nc")
    parser.add_argument("-o", "--output", type=Path, help="directory (default that of the dataset)")
    parser.set_defaults(run=plot)


def plot(told: argparse.Namespace) -> int:
    """Draw a dataset, print the milestones if it is the paper's cable, and name the figures."""
    directory = told.output or told.dataset.parent
    try:
        directory.mkdir(parents=True, exist_ok=True)
        figures = draw(told.dataset, directory)
        rows = milestones_table(told.dataset)
    except OSError as error:
        raise Failure(f"{told.dataset} cannot be drawn: {error.strerror or error}") from None
    print("\n".join([rows, *map(str, figures)] if rows else map(str, figures)))
    return 0


def draw(path: Path, directory: Path) -> list[Path]:
    """Draw the dataset's figures into a directory: snapshots, energies, and topology if it was computed.

    Raises Failure for a dataset that lacks what a figure shows, OSError if a file cannot be read or written.
    """
    from hockle import figures
    from service.results import open_dataset

    with open_dataset(path) as dataset:
        if dataset.sizes["time"] < 2:
            raise Failure(f"{path} has {dataset.sizes['time']} frames: too few to draw")
        drawings = {"energies": figures.energies}
        if {"r", "orientation"} <= set(dataset.data_vars):
            drawings["snapshots"] = figures.snapshots
        if dataset.Wr.notnull().any():
            drawings["topology"] = figures.topology
        return [
            _save(drawings[name](dataset), directory / f"{path.stem}-{name}.png") for name in sorted(drawings)
        ]


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


def _save(figure: Any, path: Path) -> Path:
    figure.savefig(path, dpi=150)
    return path
