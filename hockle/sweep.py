"""hockle sweep: one case many times, with other values."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from hockle.connection import PATIENCE, add_server, connected
from hockle.failure import Failure

METHODS = ("latin_hypercube", "sobol", "saltelli")


def register(subparsers: Any) -> None:
    """Add `hockle sweep`."""
    parser = subparsers.add_parser("sweep", help="hand a case to a server many times, with other values")
    parser.add_argument("case", metavar="CASE", help="a shipped name or a file")
    parser.add_argument("vary", metavar="KEY=VALUES", nargs="+",
                        help="values with commas between, as loads.damping=0,0.1,0.2; or a range, as loads.damping=0:1")
    parser.add_argument("--sample", choices=METHODS, help="fill the ranges so, instead of a grid")
    parser.add_argument("--size", type=int, help="how many points the sample has")
    parser.add_argument("--seed", type=int, default=0, help="the same seed gives the same sample")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings",
                        help="change a value of all, as numerics.intervals=400")
    parser.add_argument("--label", default="", help="a word of yours, to find the jobs by")
    parser.add_argument("--scalars", metavar="NAMES", help="wait, and write the last values of these, as Tw,Wr, as CSV")
    parser.add_argument("-o", "--output", type=Path, help="where to (default: the terminal)")
    parser.set_defaults(run=sweep)
    add_server(parser)


def sweep(arguments: argparse.Namespace) -> int:
    """Hand in the cases, and print the ensemble's id; wait for its numbers if any are asked for."""
    from hockle.settings import read_case

    if arguments.sample and arguments.size is None:
        raise Failure(f"--sample {arguments.sample} needs --size: how many points")
    names = _scalars(arguments.scalars) if arguments.scalars else []
    case = read_case(arguments.case, arguments.settings)
    parameters = dict(_varied(text) for text in arguments.vary)
    with connected(arguments.server) as client:
        ensemble = client.sweep(case, parameters, sample=arguments.sample, size=arguments.size, seed=arguments.seed,
                                label=arguments.label)
        print(ensemble.id, file=sys.stderr if arguments.scalars else sys.stdout, flush=True)
        if not names:
            return 0
        client.patience = PATIENCE
        ensemble.wait(progress=True)
        table = ensemble.csv(*names)
    if arguments.output is None:
        print(table, end="")
    else:
        arguments.output.write_text(table, encoding="utf-8")
    return 0 if ensemble.status == "successful" else 1


def _scalars(text: str) -> list[str]:
    """The names, known before anything is run. Raises Failure."""
    from service.results import UnknownVariable
    from service.results.scalars import scalar_variables

    try:
        return scalar_variables(text.split(","))
    except UnknownVariable as error:
        raise Failure(f"--scalars: {error}") from None


def _varied(text: str) -> tuple[str, Any]:
    """A key, and its values or its range."""
    from hockle_client import Range

    key, equals, values = text.partition("=")
    if not equals or not key or not values:
        raise Failure(f"KEY=VALUES must have both, got {text!r}")
    low, colon, high = values.partition(":")
    try:
        if colon:
            return key, Range(float(low), float(high))
        return key, json.loads(f"[{values}]")
    except ValueError:
        raise Failure(f"{key}= must be numbers with commas between, or LOW:HIGH, got {values!r}") from None
