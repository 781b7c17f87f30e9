"""The peers, run for real: one file each, `solve(cantilever, elements)` in each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from benchmarks.work_precision.cantilever import Cantilever, Elements, Motion
from benchmarks.work_precision.measure import AS_IT_COMES, MUJOCO, PYELASTICA, Measured, Run
from benchmarks.work_precision.peers import mujoco_cable, pyelastica

SOLVE: dict[str, Callable[[Cantilever, Elements], Motion]] = {
    PYELASTICA: pyelastica.solve,
    f"{MUJOCO}, RK4": partial(mujoco_cable.solve, integrator="RK4"),
    f"{MUJOCO}, Euler": partial(mujoco_cable.solve, integrator="Euler"),
}


def peers(scene: str, cantilever: Cantilever, judge: Callable[[Motion], dict[str, Measured]],
          counts: Sequence[int], as_they_come: Sequence[int]) -> list[Run]:  # fmt: skip
    """Runs of the peers with so many elements, their clamps corrected; of some also as they come."""
    runs = []
    for name, solve in SOLVE.items():
        for corrected, numbers in ((True, counts), (False, as_they_come)):
            for n in numbers:
                go = partial(_go, solve, cantilever, Elements(n, corrected), judge)
                runs.append(Run(scene, name if corrected else name + AS_IT_COMES, f"{n} elements", go))
    return runs


def _go(solve: Callable[[Cantilever, Elements], Motion], cantilever: Cantilever, elements: Elements,
        judge: Callable[[Motion], dict[str, Measured]]) -> dict[str, Measured]:  # fmt: skip
    return judge(solve(cantilever, elements))
