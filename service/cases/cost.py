"""What a case would cost, estimated before it runs.

    steps   = t_end / dt_max, and no fewer than frames and the points of schedules; times
              (usual increment_tolerance / increment_tolerance)^(1/order of the error of a step), where that is smaller
    seconds = steps (STEP + STEP_NODE n + POINT p + PAIR q) + frames (FRAME + FRAME_NODE n + WRITHE n^2)
              n nodes, p contact points, q pairs of these that may feel each other
    of statics: steps = frames + 15, seconds = steps STATIC_NODE n + ..., where solids are in the way ON_SOLIDS as much;
              with contact steps = 10 frames + 10 of STATIC_CONTACT_NODE n each
    bytes   = 8 frames n (components of the stored fields), before compression

With `verify` five times the seconds (the second run has twice the intervals and steps) and twice the bytes. With a
`tolerance`, whose meshes are not known before: n of the usual mesh, a step a frame, twice the bytes; or the seconds
that such scenes take (`outlook`) if these are more; a tolerance below the usual one makes it (usual/tolerance)^(1/2)
times as much, up to the MOST after which it ends. Of statics with a tolerance the seconds are those that such scenes
take, (usual/tolerance)^(1/4) times as much.

The rates are CPU seconds measured by `python -m benchmarks` on one core of the machine that its results name: those of
a step from goyal-2003 to 32 s (about two Newton iterations a step, contact included), WRITHE of a rod whose strands lie
side by side, so that no pair can be spared. Real runs take more steps where the motion is fast, and fewer seconds on a
faster core: it is an estimate, and what is refused by it is far beyond what one run should be.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil

from service.cases.build import build_scene
from service.cases.case import TOLERANCE, CaseSpec
from service.cases.errors import CaseError, FieldError
from service.cases.outlook import MOST, likely_seconds
from service.cases.quantities import ScheduleTable
from service.cases.size import contact_points, tables_in
from solver.measures.frame import OUTPUTS
from solver.methods.registry import METHODS

STEP, STEP_NODE = 330e-6, 2.9e-6
STATIC_NODE = 24e-6  # four linearisations
ON_SOLIDS = 2.5
STATIC_CONTACT_NODE = 2.5e-4  # six, and a count of all rotations together
FRAME, FRAME_NODE = 100e-6, 4e-6
WRITHE = 1.5e-9
POINT, PAIR = 1e-7, 5e-9
VERIFIED = 5
ELSEWHERE = 1.1
"""How many times longer a run to a tolerance is said to take than on the EPYC that the outlook was fitted to: an Intel
Xeon takes 1.37 times as long. Of the 204 scenes of the bank 92 % are so within a factor of 3 on the one, 94 on the
other."""
MOST_HALVED = 2.0**22
"""How often steps may be halved."""
COMPONENTS = {output.name: output.components for output in OUTPUTS}


@dataclass(frozen=True)
class Cost:
    """What a case asks for; `seconds` of one core, `bytes` of the fields along the rod."""

    nodes: int
    frames: int
    steps: int
    seconds: float
    bytes: int


def estimate(spec: CaseSpec) -> Cost:
    """The cost of a case, by the model above. Raises CaseError where its parts do not fit each other."""
    cost, tolerance = by_size(spec), spec.numerics.tolerance
    if tolerance is None:
        return cost
    likely = ELSEWHERE * likely_seconds(build_scene(spec))
    if spec.analysis == "static":
        return replace(cost, seconds=likely * _finer(tolerance) ** 0.5)
    return replace(cost, seconds=max(cost.seconds, min(likely * _finer(tolerance), max(likely, MOST))))


def by_size(spec: CaseSpec) -> Cost:
    """The least that a case of its nodes, frames and steps costs, whatever its motion."""
    numerics = spec.numerics
    nodes, frames = numerics.expected_intervals + 1, spec.frames
    points, pairs = contact_points(spec)
    if spec.analysis == "static":
        steps, step = frames + 15, STATIC_NODE * nodes
        if spec.loads.floor is not None or spec.loads.obstacles:
            step *= ON_SOLIDS
        if spec.contact is not None:
            steps, step = 10 * frames + 10, STATIC_CONTACT_NODE * nodes
    else:
        steps, step = _steps(spec), STEP + STEP_NODE * nodes + POINT * points + PAIR * pairs
    frame = FRAME + FRAME_NODE * nodes + (WRITHE * nodes**2 if spec.output.topology else 0.0)
    seconds = steps * step + frames * frame
    if numerics.tolerance:
        seconds = max(seconds, min(seconds * _finer(numerics.tolerance), MOST + frames * frame))
    elif numerics.verify:
        seconds *= VERIFIED
    components = sum(COMPONENTS[name] for name in spec.output.fields) * (2 if numerics.has_errors else 1)
    return Cost(nodes, frames, steps, seconds, 8 * frames * nodes * components)


def _finer(tolerance: float) -> float:
    """How many times more a tolerance below the usual one costs."""
    return float(max(TOLERANCE / tolerance, 1.0) ** 0.5)


def _steps(spec: CaseSpec) -> int:
    """The steps of a dynamic analysis."""
    numerics = spec.numerics
    corners = {t for _, table in tables_in(spec) if isinstance(table, ScheduleTable) for t in table.t}
    least = max(spec.frames - 1, sum(0.0 < t < spec.t_end for t in corners))
    steps = max(spec.t_end / (numerics.dt_max or spec.output.interval), least)
    if numerics.increment_tolerance:
        method = METHODS[numerics.method][-1]
        finer = method.increment_tolerance / numerics.increment_tolerance
        steps *= min(max(finer, 1.0) ** (1.0 / method.increment_order), MOST_HALVED)
    return ceil(steps)


def check_cost(spec: CaseSpec, most: float) -> None:
    """Raises CaseError for a case that by its size alone costs more than `most` seconds."""
    cost = by_size(spec)
    if cost.seconds > most:
        rule = (f"must leave at most {most:,.0f} s of computing, not about {cost.seconds:,.0f} s "
                f"({cost.steps:,} steps of {cost.nodes:,} nodes, {cost.frames:,} frames): end earlier, "
                "or use fewer intervals, longer steps or a longer output.interval")
        raise CaseError([FieldError("/t_end", spec.t_end, rule)])
