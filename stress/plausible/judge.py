"""`python -m stress.plausible.judge`: are the error bars of the bank's answers true, and what would fixed meshes cost?

The truth of a scene is a run of its own to TRUTH of the tolerance, with WORK times the work. An answer's true errors
are those of r, kappa, the energies, and Tw and Wr, in the measures of a tolerance (`solver.run.accuracy`). The cheapest
fixed run is the one of FIXED meshes and step tolerances that takes least CPU time of those that are as good: of which
no error is larger than the answer's, or than SMALL of the tolerance, or than the truth is known. The cheapest of which
only the largest error is no larger is told too: where the curvature jumps, no mesh resolves it, and all errors but its
own may then be what they like.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field, replace
from multiprocessing import get_context
from statistics import median
from time import process_time

import numpy as np

from service.cases import build_scene, parse_case
from solver import Frame, Run, RunFailed, Scene
from solver.arrays import Array
from solver.physics.seed import seeded
from solver.run import budget
from solver.run.accuracy import errors_of, excess, sizes
from solver.run.equilibria import Equilibria
from solver.run.first_mesh import first_intervals
from solver.run.recording import Columns, columns_of, row_of
from solver.run.refined import Refined
from solver.run.simulation import Simulation
from solver.run.trial import FIRST_INTERVALS
from solver.run.verify import VerifiedFrame
from stress.plausible.__main__ import PROCESSES, RESULTS
from stress.plausible.bank import KINDS, scene
from stress.report import table
from validation.error_bars import MISSED, missed, misses
from validation.provenance import provenance

TRUTH, WORK, SMALL = 0.02, 12.0, 0.1
STEPS = 4
FIXED = [(FIRST_INTERVALS * 2**mesh, 0.1**steps) for mesh in range(7) for steps in range(1, STEPS + 1)]
LONGEST, DEAR = 300.0, 2.0
"""Seconds of CPU time after which a truth is given up; and how many times the answer's a fixed run may take."""
HEADER = ("kind", "scenes", "values outside 3 bars", "largest", "CPU s, median", "over the cheapest fixed run, median",
          "largest")  # fmt: skip


@dataclass
class Verdict:
    """Of an answer: its `cpu` (s), the part of its values `outside` three bars and which variables they are of, its
    largest true `error` over the tolerance and that of the truth as that tells it, and `fixed` and `fixed_by_largest`,
    the CPU times (s) of the cheapest fixed runs (NaN if none is as good for DEAR times the answer's). `unjudged`: why
    there is none."""

    kind: str
    number: int
    unjudged: str = ""
    cpu: float = 0.0
    outside: float = 0.0
    by_variable: dict[str, float] = field(default_factory=dict)
    error: float = 0.0
    error_of_truth: float = 0.0
    fixed: float = float("nan")
    fixed_by_largest: float = float("nan")


def judge(kind: str, number: int) -> Verdict:
    """Run a scene, its truth and fixed runs."""
    built = seeded(build_scene(parse_case(scene(kind, number))))  # as `simulate` runs it
    verdict = Verdict(kind, number)
    try:
        answer, verdict.cpu, _ = _refined(built)
        truth, told = _true(built)
    except (RunFailed, TimeoutError) as error:
        verdict.unjudged = str(error)[:80]
        return verdict
    counts = misses(answer, truth)
    verdict.outside = missed(counts)
    verdict.by_variable = {name: round(far / many, 3) for name, (far, many) in counts.items() if far > MISSED * many}
    errors, known = _errors(built, answer, truth), excess(built.numerics.tolerance or 0.0, told)
    verdict.error, verdict.error_of_truth = float(errors.max()), float(known.max())
    bounds = np.maximum(np.maximum(errors, known), SMALL)
    too_dear: list[tuple[int, float]] = []
    alike = first_intervals(built) / FIRST_INTERVALS  # meshes that have nodes in common with those of the answer
    at_rest = built.analysis == "static"  # whose steps are no choice
    for sixteenths, tolerated in FIXED[:: STEPS if at_rest else 1]:
        intervals = int(sixteenths * alike)
        if any(intervals >= mesh and tolerated <= steps for mesh, steps in too_dear):
            continue
        try:
            most = float(np.nanmin([verdict.fixed, DEAR * verdict.cpu]))
            frames, cpu = _fixed(built, intervals, tolerated, most)
        except RunFailed:
            continue
        except TimeoutError:
            too_dear.append((intervals, tolerated))
            continue
        its_errors = _errors(built, frames, truth)
        if np.all(its_errors <= bounds):
            verdict.fixed = cpu
        if its_errors.max() <= bounds.max():
            verdict.fixed_by_largest = float(np.nanmin([verdict.fixed_by_largest, cpu]))
    return verdict


def _refined(scene: Scene) -> tuple[list[VerifiedFrame], float, Array]:
    """Its frames, its CPU time (s), and its errors (frames, 4) as it tells them."""
    begun = Refined(scene)
    begun.warm()
    started, frames = process_time(), []
    while not begun.finished:
        frame = begun.advance()
        if isinstance(frame, VerifiedFrame):
            frames.append(frame)
        if process_time() - started > LONGEST:
            raise TimeoutError("no answer in time")
    return frames, process_time() - started, begun.errors_of_frames


def _true(scene: Scene) -> tuple[list[VerifiedFrame], Array]:
    """Its frames and its errors."""
    tolerance, work = scene.numerics.tolerance or 0.0, budget.MOST_WORK
    budget.MOST_WORK = WORK * work
    try:
        frames, _, told = _refined(replace(scene, numerics=replace(scene.numerics, tolerance=TRUTH * tolerance)))
    finally:
        budget.MOST_WORK = work
    return frames, told


def _fixed(scene: Scene, intervals: int, tolerated: float, most: float) -> tuple[list[Frame], float]:
    """The frames of a fixed run and its CPU time (s). Raises TimeoutError after `most` s."""
    numerics = replace(scene.numerics, tolerance=None, method="staggered", intervals=intervals,
                       dt_max=scene.output_interval, increment_tolerance=tolerated)  # fmt: skip
    resolved = replace(scene, numerics=numerics)
    begun: Run = Equilibria(resolved) if scene.analysis == "static" else Simulation(resolved, goes_on=True)
    begun.warm()
    started, frames = process_time(), []
    while not begun.finished:
        frame = begun.advance()
        if frame is not None:
            frames.append(frame)
        if process_time() - started > most:
            raise TimeoutError
    return frames, process_time() - started


def _errors(scene: Scene, frames: Sequence[Frame], truth: Sequence[Frame]) -> Array:
    """The true errors of the quantities of a tolerance (4,), over the tolerance."""
    answer, exact = (columns_of([row_of(frame) for frame in series], judged=True) for series in (frames, truth))
    many = [columns.along.shape[1] - 1 for columns in (answer, exact)]
    strides = [count // min(many) for count in many]
    along = answer.along[:, :: strides[0]] - exact.along[:, :: strides[1]]
    apart = Columns(np.abs(along), np.abs(answer.numbers - exact.numbers))
    return excess(scene.numerics.tolerance or 1.0, errors_of(apart, sizes(scene, [exact])))


def main() -> int:
    """Judge so many scenes of each kind; write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--each", type=int, default=3, help="scenes of each kind")
    parser.add_argument("--kinds", default=",".join(KINDS), help="by name, with commas")
    arguments = parser.parse_args()
    tasks = [(kind, number) for kind in arguments.kinds.split(",") for number in range(arguments.each)]
    verdicts = []
    with ProcessPoolExecutor(PROCESSES, get_context("spawn")) as pool:
        for future in as_completed([pool.submit(judge, *task) for task in tasks]):
            verdicts.append(future.result())
            print(json.dumps(asdict(verdicts[-1])), flush=True)
    verdicts.sort(key=lambda verdict: (verdict.kind, verdict.number))
    text = "\n".join([f"Measured with {'; '.join(provenance())}.", "", *written(verdicts)])
    print(text)
    (RESULTS / "judged.md").write_text(f"# Are the answers' errors true, and what do they cost\n\n{text}\n")
    (RESULTS / "judged.json").write_text(json.dumps([asdict(verdict) for verdict in verdicts], indent=1) + "\n")
    return 0


def written(verdicts: Sequence[Verdict]) -> list[str]:
    """The table by kinds, and what all say."""
    judged = [verdict for verdict in verdicts if not verdict.unjudged]
    kinds = sorted({verdict.kind for verdict in judged})
    rows = [_row(kind, [verdict for verdict in judged if verdict.kind == kind]) for kind in kinds]
    true = sum(verdict.outside <= MISSED for verdict in judged) / max(len(judged), 1)
    by_largest = [verdict.cpu / verdict.fixed_by_largest for verdict in judged if verdict.fixed_by_largest > 0.0]
    return [
        *table(HEADER, rows), "",
        f"- At least {1 - MISSED:.0%} of the values within three bars: in {true:.1%} of {len(judged)} scenes "
        "(aim 95 %).",
        "- CPU time over that of the cheapest fixed run with no error larger: " + _spread(_ratios(judged)) + ".",
        "- With the largest error no larger: " + _spread([*by_largest, *[1.0 / DEAR] * (len(judged) - len(by_largest))])
        + ".",
        f"- Where no fixed run was as good for {DEAR:g} times the answer's CPU time, 1 / {DEAR:g} counts.",
        *(f"- Not judged: {verdict.kind} {verdict.number}, {verdict.unjudged}"
          for verdict in verdicts if verdict.unjudged),
    ]  # fmt: skip


def _ratios(verdicts: Sequence[Verdict]) -> list[float]:
    return [verdict.cpu / verdict.fixed if verdict.fixed > 0.0 else 1.0 / DEAR for verdict in verdicts]


def _spread(ratios: Sequence[float]) -> str:
    return f"median {np.median(ratios):.2f} (aim 2), 95 % within {np.quantile(ratios, 0.95):.1f} (aim 6)"


def _row(name: str, verdicts: Sequence[Verdict]) -> list[str]:
    outside, ratios = [verdict.outside for verdict in verdicts], _ratios(verdicts)
    cpu = median(verdict.cpu for verdict in verdicts)
    return [name, str(len(verdicts)), f"{median(outside):.3f}", f"{max(outside):.3f}", f"{cpu:.2f}",
            f"{median(ratios):.2f}", f"{max(ratios):.1f}"]  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(main())
