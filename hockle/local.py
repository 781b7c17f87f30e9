"""hockle run, cases, schema, validate: the commands that need no server."""

from __future__ import annotations

import argparse
import errno
import sys
from collections.abc import Iterator
from math import isnan
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

from hockle.failure import Failure

if TYPE_CHECKING:
    from service.cases import CaseSpec
    from service.results import DatasetWriter
    from solver import Run, RunFailed

LOADING = "compiling or loading the solver"
SHOWN_EVERY = 0.1
"""Seconds between two looks of the progress bar."""
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def register(subparsers: Any) -> None:
    """Add `hockle run`, `hockle validate`, `hockle cases` and `hockle schema`."""
    run_parser = subparsers.add_parser("run", help="simulate a case here and write its dataset")
    run_parser.add_argument("-o", "--output", type=Path, help="the dataset (default NAME.nc)")
    run_parser.set_defaults(run=run)
    run_parser.add_argument("case", metavar="CASE", help="a shipped name or a file")
    validate_parser = subparsers.add_parser("validate", help="check cases without running them")
    validate_parser.set_defaults(run=validate)
    validate_parser.add_argument("cases", nargs="+", metavar="CASE", help="a shipped name or a file")
    for parser in (run_parser, validate_parser):
        parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings",
                            help="change a value of the case, as numerics.intervals=400")  # fmt: skip
    cases_parser = subparsers.add_parser("cases", help="list the shipped cases, or print one")
    cases_parser.add_argument("name", nargs="?", metavar="SHIPPED", help="the case to print, as JSON")
    cases_parser.set_defaults(run=cases)
    subparsers.add_parser("schema", help="print the JSON schema of a case").set_defaults(run=schema)


def cases(arguments: argparse.Namespace) -> int:
    """Print the shipped cases, or the text of one."""
    from service.cases import CaseError, shipped_case, shipped_cases

    if arguments.name is not None:
        try:
            print(shipped_case(arguments.name))
        except CaseError as error:
            raise Failure(str(error)) from None
        return 0
    titles = shipped_cases()
    width = max(map(len, titles))
    for name, title in titles.items():
        print(f"{name:{width}}  {title}")
    return 0


def schema(_: argparse.Namespace) -> int:
    """Print the JSON schema of a case."""
    from json import dumps

    from service.cases import case_schema

    print(dumps(case_schema(), indent=2))
    return 0


def validate(arguments: argparse.Namespace) -> int:
    """Print what each case would cost and what looks like a slip in it, or everything that is wrong with it; 1 if any
    cannot be run."""
    refused = 0
    for case in arguments.cases:
        named = f"{case}: " if len(arguments.cases) > 1 else ""
        try:
            _validate(_spec(case, arguments.settings), named)
        except Failure as failure:
            print(f"hockle: {named}{failure}", file=sys.stderr)
            refused = 1
    return refused


def _validate(spec: CaseSpec, named: str) -> None:
    """Print what there is to say of a case; `named`: what its warnings begin with."""
    from service.cases import build_scene, estimate, warnings_of

    cost = estimate(spec)
    intervals, dt_max = spec.numerics.intervals, spec.numerics.dt_max
    if intervals is None or dt_max is None:
        size = f"{spec.frames} frames, nodes and steps as a tolerance of {spec.numerics.tolerance} needs"
    else:
        steps = spec.frames - 1 if spec.analysis == "static" else spec.t_end / dt_max
        size = f"{intervals + 1} nodes, {spec.frames} frames, {steps:.0f} steps or more"
    print(f"{spec.name} is valid: {size}; likely {cost.seconds:.2g} s of CPU, {cost.bytes / 1e6:.2g} MB",
          flush=True)  # before its warnings
    for warning in warnings_of(spec, build_scene(spec)):
        print(f"{named}warning: {warning}", file=sys.stderr)


def run(arguments: argparse.Namespace) -> int:
    """Simulate a case, with a progress bar, and print a summary; 1 if the run failed, 130 if interrupted."""
    spec = _spec(arguments.case, arguments.settings)
    path = arguments.output or Path(f"{spec.name}.nc")
    if path.is_dir():
        raise Failure(f"{path} is a directory: -o takes the name of a file")
    try:
        failure = _simulate(spec, path)
    except OSError as error:
        raise Failure(_not_written(path, error)) from None
    except KeyboardInterrupt:
        print(f"hockle: interrupted, nothing was written to {path}", file=sys.stderr)
        return 130
    print(summary(path))
    if failure is None:
        return 0
    print(f"hockle: {failure}", file=sys.stderr)
    return 1


def summary(path: Path) -> str:
    """How the run of a dataset ended, what it cost, and its last frame's balance."""
    from netCDF4 import Dataset

    from outcomes import Outcome

    with Dataset(path) as dataset:
        dataset.set_auto_mask(False)
        attributes = dataset.__dict__
        frames = len(dataset["time"])
        lines = [
            f"{attributes['case_name']}: {attributes['outcome']}",
            f"  steps {attributes['steps']} ({attributes['failed_steps']} repeated), "
            f"Newton iterations {attributes['newton_iterations']}, CPU {attributes['cpu_time']:.2f} s",
        ]
        if frames:
            last = {name: float(v[-1]) for name, v in dataset.variables.items() if v.dimensions == ("time",)}
            energies = [name for name in last if name.startswith("energy_")]
            stored = sum(last[name] for name in energies if not name.endswith(("_balance", "_error")))
            lines += [
                f"  at t = {last['time']:g} s: {_topology(last)}",
                f"  energy {stored:.4g} J, " + _trust(last, "turning_loads" in attributes),
            ]
        if attributes["outcome"] == Outcome.COMPLETED and attributes["message"]:
            lines.append(f"  {attributes['message']}")
    return "\n".join(
        [*lines, f"  {path} ({path.stat().st_size / 1e6:.1f} MB, {frames} frames)"]
    )


def _topology(last: dict[str, float]) -> str:
    """Tw, Wr and Lk, those that there are: Lk of a static analysis is known where both ends are held."""
    return ", ".join(f"{name} {last[name]:z.4f}" for name in ("Tw", "Wr", "Lk") if not isnan(last[name]))


def _trust(last: dict[str, float], turning: bool) -> str:
    """What a dynamic run's last frame says of its error, or a static one's of its stability, unless loads are
    `turning` with the rod: then nothing follows."""
    if "negative_modes" not in last:
        return f"balance {last['energy_balance']:.2g} J"
    if turning:
        return f"parameter {last['parameter']:g} s"
    falling, neutral = int(last["negative_modes"]), int(last["neutral_modes"])
    verdict = f"unstable in {falling} {_directions(falling)}" if falling else "stable"
    verdict += f", free to move in {neutral} {_directions(neutral)}" if neutral else ""
    return f"parameter {last['parameter']:g} s, {verdict}"


def _directions(many: int) -> str:
    return "direction" if many == 1 else "directions"


def _spec(case: str, settings: list[str]) -> CaseSpec:
    from hockle.settings import read_case
    from service.cases import CaseError, parse_case

    raw = read_case(case, settings)
    try:
        return parse_case(raw)
    except CaseError as error:
        raise Failure(str(error)) from None


def _simulate(spec: CaseSpec, path: Path) -> RunFailed | None:
    """Run and write the dataset; of a run that failed, the frames so far and the failure."""
    from hockle.progress import show
    from outcomes import Outcome
    from service.cases import build_scene
    from service.results import DatasetWriter
    from solver import RunFailed, simulate

    simulation = simulate(build_scene(spec))
    failure: RunFailed | None = None
    with DatasetWriter(path, spec) as writer:
        try:
            show(_progress(spec, simulation, writer))
        except RunFailed as failed:
            failure = failed
        outcome = failure.outcome if failure else Outcome.COMPLETED
        message = " ".join([str(failure or ""), *simulation.notes()]).strip()
        writer.publish(outcome.value, message, simulation)
    return failure


def _progress(spec: CaseSpec, simulation: Run, writer: DatasetWriter) -> Iterator[dict[str, Any]]:
    """Write the frames as they come, and say now and then what the progress bar shows; first, that the solver is
    loaded."""
    state = {"status": spec.name, "progress": 0.0, "t": 0.0}
    yield state | {"phase": LOADING}
    simulation.warm()
    shown = 0.0
    while not simulation.finished:
        frame = simulation.advance()
        if frame is not None:
            writer.append(frame)
        if monotonic() - shown >= SHOWN_EVERY:
            shown = monotonic()
            yield state | {"phase": simulation.phase, "progress": simulation.progress, "t": simulation.t}
    yield state | {"phase": simulation.phase, "progress": 1.0, "t": simulation.t}


def _not_written(path: Path, error: OSError) -> str:
    if error.errno in FULL:
        return (
            f"the disk is full, nothing was written to {path}: make room, or store less "
            "(--set output.interval=..., --set 'output.fields=[\"r\"]')"
        )
    return f"nothing was written to {path}: {error.strerror or error}"
