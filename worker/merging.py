"""The state of a run that has begun as another one has.

docs/decisions/0022-shared-beginnings.md
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

OF_THE_FUTURE = re.compile(r"\._outputs\b|\._control\._events\b|\._switches\b|\._jolts\b|"
                           r"\.(start|end)\._components\b|\.applied\b|\.address$")
"""Where a run holds what comes: the only places where the runs of two cases with one beginning may differ."""


class AnotherBeginning(Exception):
    """A run cannot begin from the state of another: they differ in more than what comes later."""


def begun(fresh: Mapping[str, Any], other: Mapping[str, Any], reached: Mapping[str, Any]) -> dict[str, Any]:
    """The state of a run that has begun as another one has: what that has changed since its start is as it has
    `reached` it, all the rest as in a `fresh` run. `other` is a fresh run of the other's case.

    Raises AnotherBeginning where the fresh ones differ in more than what comes later.
    """
    state = {}
    for path in sorted(fresh.keys() | reached.keys()):
        changed = path not in other or (path in reached and not _same(reached[path], other[path]))
        apart = path in fresh and path in other and not _same(fresh[path], other[path])
        if apart and not OF_THE_FUTURE.search(path):
            raise AnotherBeginning(f"{path} is another one")
        if path in reached and changed and not apart:
            state[path] = reached[path]
        elif path in fresh:
            state[path] = fresh[path]
    return _switched(state, fresh, other, reached)


def _switched(state: dict[str, Any], fresh: Mapping[str, Any], other: Mapping[str, Any],
              reached: Mapping[str, Any]) -> dict[str, Any]:  # fmt: skip
    """With the switches that are still to come: those of the fresh run less the ones that the other has made."""
    for path in [path for path in fresh if path.endswith("._switches[]")]:
        passed = other[path] - reached[path]
        name = path.removesuffix("[]")
        for item in [item for item in state if item.startswith(f"{name}[") and item != path]:
            del state[item]
        state[path] = fresh[path] - passed
        state |= {f"{name}[{i}]": fresh[f"{name}[{i + passed}]"] for i in range(state[path])}
    return state


def _same(value: Any, other: Any) -> bool:
    if isinstance(value, np.ndarray) or isinstance(other, np.ndarray):
        return np.shape(value) == np.shape(other) and np.array_equal(value, other, equal_nan=True)
    return bool(value == other) or (value != value and other != other)
