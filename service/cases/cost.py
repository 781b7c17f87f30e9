"""What a case would cost, estimated before it runs.

    steps   = t_end / dt_max, and no fewer than frames
    seconds = steps (STEP + STEP_NODE n) + frames (FRAME + FRAME_NODE n + WRITHE n^2)        n nodes
    of statics: steps = 2 frames + 10, seconds = steps STATIC_NODE n + ...
    bytes   = 8 frames n (components of the stored fields), before compression

With `verify` five times the seconds (the second run has twice the intervals and steps) and twice the bytes. With a
`tolerance`, whose meshes are not known before: n of the usual mesh, a step a frame, twice the seconds and the bytes.

The rates are CPU seconds measured by `python -m benchmarks` on one core of the machine that its results name: those of
a step from goyal-2003 to 32 s (about two Newton iterations a step, contact included), WRITHE of a rod whose strands lie
side by side, so that no pair can be spared. Real runs take more steps where the motion is fast, and fewer seconds on a
faster core: it is an estimate, and what is refused by it is far beyond what one run should be.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from service.cases.case import CaseSpec
from service.cases.errors import CaseError, FieldError
from solver.measures.frame import OUTPUTS

STEP, STEP_NODE = 330e-6, 2.9e-6
STATIC_NODE = 26e-6  # four linearisations
FRAME, FRAME_NODE = 100e-6, 4e-6
WRITHE = 1.5e-9
PILOTS, VERIFIED = 2, 5
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
    """The cost of a case, by the model above."""
    numerics = spec.numerics
    nodes, frames = numerics.expected_intervals + 1, spec.frames
    steps = max(ceil(spec.t_end / (numerics.dt_max or spec.output.interval)), frames - 1)
    step = STEP + STEP_NODE * nodes
    if spec.analysis == "static":
        steps, step = 2 * frames + 10, STATIC_NODE * nodes
    frame = FRAME + FRAME_NODE * nodes + (WRITHE * nodes**2 if spec.output.topology else 0.0)
    seconds = steps * step + frames * frame
    seconds *= (PILOTS if numerics.tolerance else 1) * (VERIFIED if numerics.verify else 1)
    components = sum(COMPONENTS[name] for name in spec.output.fields) * (2 if numerics.has_errors else 1)
    return Cost(nodes, frames, steps, seconds, 8 * frames * nodes * components)


def check_cost(spec: CaseSpec, most: float) -> Cost:
    """The cost of a case. Raises CaseError if it is more than `most` seconds."""
    cost = estimate(spec)
    if cost.seconds > most:
        rule = (f"must leave at most {most:,.0f} s of computing, not about {cost.seconds:,.0f} s "
                f"({cost.steps:,} steps of {cost.nodes:,} nodes, {cost.frames:,} frames): end earlier, "
                "or use fewer intervals, longer steps or a longer output.interval")
        raise CaseError([FieldError("/t_end", spec.t_end, rule)])
    return cost
