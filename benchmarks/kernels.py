"""CPU time of one Newton iteration of each method, split into its parts; for the box method, of both linear solves."""

from __future__ import annotations

from collections.abc import Callable
from time import process_time

from solver import Curve, End, Initial, Numerics, Scene
from solver.methods.box import BoxMethod
from solver.methods.staggered import StaggeredMethod
from validation.free_flight import curled
from validation.rods import LENGTH, rod_R
from validation.system import NewtonSystem, StagesSystem

INTERVALS = (100, 200, 400, 1000)
AIM_US = {1000: 500.0}
WRITHE_AIM_US = {1000: 20e3}


def best(action: Callable[[], object], repeats: int = 7, each: int = 20) -> float:
    """Process CPU time (us) of one call, the best of several means."""
    action()
    times = []
    for _ in range(repeats):
        started = process_time()
        for _ in range(each):
            action()
        times.append((process_time() - started) / each)
    return 1e6 * min(times)


def scene_of(intervals: int) -> Scene:
    """A curled rod, 10 mm thick, that is let go."""
    return Scene(
        rod=rod_R(), initial=Initial(centreline=curled, twist=Curve.constant(0.0)), start=End.clamp(), end=End.free(),
        t_end=LENGTH, output_interval=LENGTH, numerics=Numerics(intervals=intervals), topology=False,
    )  # fmt: skip


def cost(intervals: int) -> dict[str, float]:
    """CPU time (us) of assembly, factor, solve, their sum, of shooting, and of assembly with shooting.

    At a step of 0.1 s: where shooting works too.
    """
    system = NewtonSystem(BoxMethod(scene_of(intervals)), 0.1)
    system.assemble()
    parts = {
        "intervals": float(intervals),
        "assembly": best(system.assemble),
        "factor": best(system.factor),
        "solve": best(system.solve),
        "shooting": best(system.shoot),
    }
    parts["total"] = parts["assembly"] + parts["factor"] + parts["solve"]
    parts["total, shooting"] = parts["assembly"] + parts["shooting"]
    return parts


def staggered_cost(intervals: int) -> dict[str, float]:
    """CPU time (us) of the motion, the residuals and the solve of all three stages, their sum; and, once a step, of
    tangents with both factorizations."""
    system = StagesSystem(StaggeredMethod(scene_of(intervals)), 0.01)
    system.factor()
    system.evaluate()
    parts = {
        "intervals": float(intervals),
        "motion": best(system.move),
        "residuals": best(system.evaluate),
        "solve": best(system.solve),
        "update": best(system.update),
    }
    return parts | {"total": sum(parts.values()) - intervals, "once a step": best(system.factor)}


def table() -> list[dict[str, float]]:
    """Rows of the box method for all N."""
    return [cost(intervals) for intervals in INTERVALS]


def staggered_table() -> list[dict[str, float]]:
    """Rows of the staggered method for all N."""
    return [staggered_cost(intervals) for intervals in INTERVALS]
