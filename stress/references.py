"""How far a run is from the converged solution, where there is one.

The same physics is solved twice with a mesh and steps much finer than the sweeps' own: by both methods, which share no
discretization, or in statics on two meshes. Where the two agree, the second is the reference.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np

from service.cases import apply_settings
from stress.ending import Ending, Result, Task

AGREE = 5e-3
"""In rod lengths: how far both may be from each other at any place."""
BUDGET = 30.0
FINE: dict[str, tuple[dict[str, Any], ...]] = {
    "dynamic": (
        {"method": "box", "intervals": 120, "increment_tolerance": 3e-3, "rho_inf": 0.9},
        {"method": "staggered", "intervals": 120, "increment_tolerance": 1e-3, "dt_max": 0.05},
    ),
    "static": ({"intervals": 100}, {"intervals": 200}),
}
GROUP = "reference"


def physics(task: Task) -> str:
    """What two tasks have in common that should come to the same: all but the numerics."""
    return json.dumps({key: part for key, part in task.case.items() if key != "numerics"}, sort_keys=True)


def converged(pairs: Iterable[tuple[Task, Result]], follow: Callable[[Sequence[Task]], list[Result]]) -> References:
    """The references of the physics that some run came to the end of; `follow` runs tasks.

    The second of two fine runs is made where the first one came to its end.
    """
    keys = dict.fromkeys(physics(task) for task, result in pairs if result.ending is Ending.CORRECT)
    first = follow([_fine(key, 0) for key in keys])
    second = follow([_fine(result.at[0], 1) for result in first if result.ending is Ending.CORRECT])
    return References([*first, *second])


def _fine(key: str, index: int) -> Task:
    """One of the two fine runs of some physics."""
    case = json.loads(key)
    static = case.get("analysis") == "static"
    steps = {} if static else {"dt_max": case["t_end"] / 100}
    fine = case | {"numerics": {**steps, **FINE["static" if static else "dynamic"][index]}}
    return Task(GROUP, (key, index), apply_settings(fine, {"output.topology": False}), 20_000, BUDGET)


class References:
    """The places where converged runs ended, by physics."""

    def __init__(self, results: Iterable[Result]) -> None:
        pairs: dict[str, dict[int, Result]] = {}
        for result in results:
            pairs.setdefault(result.at[0], {})[result.at[1]] = result
        self._places = {key: np.array(pair[1].r) for key, pair in pairs.items() if _agree(pair)}

    def measured(self, task: Task, result: Result) -> Result:
        """The result with its distance from the reference over the rod's length, if both came to the end."""
        reference = self._places.get(physics(task))
        if reference is None or result.ending is not Ending.CORRECT:
            return result
        return replace(result, error=_apart(np.array(result.r), reference) / task.case["rod"]["length"])


def _agree(pair: dict[int, Result]) -> bool:
    if len(pair) < 2 or pair[1].ending is not Ending.CORRECT:
        return False
    first, second = pair[0], pair[1]
    length = json.loads(first.at[0])["rod"]["length"]
    return bool(_apart(np.array(first.r), np.array(second.r)) < AGREE * length)


def _apart(first: Any, second: Any) -> float:
    return float(np.linalg.norm(first - second, axis=1).max()) if len(first) == len(second) else nan
