"""CPU time of one Newton iteration, split into its parts, for both linear solves."""

from __future__ import annotations

from collections.abc import Callable
from time import process_time

from solver import Curve, End, Initial, Numerics, Scene
from solver.methods.box.method import BoxMethod
from validation.free_flight import curled
from validation.rods import LENGTH, rod_R
from validation.system import NewtonSystem

INTERVALS = (100, 200, 400, 1000)
AIM_US = {1000: 700.0}


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


def system_of(intervals: int) -> NewtonSystem:
    """A curled rod, 10 mm thick, at a step of 0.1 s: where shooting works too."""
    scene = Scene(
        rod=rod_R(), initial=Initial(centreline=curled, twist=Curve.constant(0.0)), start=End.clamp(), end=End.free(),
        t_end=LENGTH, output_interval=LENGTH, numerics=Numerics(intervals=intervals), topology=False,
    )  # fmt: skip
    return NewtonSystem(BoxMethod(scene), 0.1)


def cost(intervals: int) -> dict[str, float]:
    """CPU time (us) of assembly, factor, solve, their sum, of shooting, and of assembly with shooting."""
    system = system_of(intervals)
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


def table() -> list[dict[str, float]]:
    """Rows for all N."""
    return [cost(intervals) for intervals in INTERVALS]
