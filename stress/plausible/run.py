"""One scene of the bank, run as a user would, and what became of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import process_time

from service.cases import CaseError, build_scene, parse_case
from service.cases.cost import estimate
from solver import RunFailed, simulate
from stress.plausible.bank import scene

ANSWERED, FAILED, LATE, REFUSED = "answered", "failed", "out of time", "refused"


@dataclass
class Report:
    """What became of a scene: how it ended, `outcome` of what failed, CPU time (s), and what the run says of itself."""

    kind: str
    number: int
    ending: str
    outcome: str = ""
    cpu: float = 0.0
    expected: float = 0.0
    frames: int = 0
    intervals: int = 0
    notes: str = ""
    attributes: dict[str, float | int | str] = field(default_factory=dict)


def run(kind: str, number: int, cpu: float) -> Report:
    """Run a scene for so many seconds of CPU time at the most."""
    try:
        spec = parse_case(scene(kind, number))
        begun = simulate(build_scene(spec))
    except CaseError as error:
        return Report(kind, number, REFUSED, str(error))
    report = Report(kind, number, ANSWERED, expected=estimate(spec).seconds)
    begun.warm()
    started = process_time()
    try:
        while not begun.finished:
            report.frames += begun.advance() is not None
            assert 0.0 <= begun.progress <= 1.0  # what every user's command asks after each step
            if process_time() - started > cpu:
                report.ending, report.outcome = LATE, begun.phase
                break
    except RunFailed as failure:
        report.ending, report.outcome = FAILED, failure.outcome.value
        report.notes = str(failure)
    report.cpu = process_time() - started
    report.intervals = len(begun.s) - 1
    if report.frames:
        report.attributes, report.notes = begun.attributes(), " ".join([report.notes, *begun.notes()]).strip()
    return report
