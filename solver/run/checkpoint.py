"""The full state of a run as arrays and numbers by name, and back: a restored run goes on bit by bit as it would have.

What a run remembers is what its objects hold. So nothing is listed here, and nothing can be forgotten: every array
and number is found by walking through the attributes of the solver's own objects. What is fixed by the scene
(frozen dataclasses, curves, functions) is left out: a run is restored into a fresh one of the same scene.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from solver.arrays import Array
from solver.kernels.kernel import code_digest as kernels_digest

Saved = dict[str, Array | float | int | bool | None]
"""Values by the path of attributes that leads to them; `path[]` is the length of a list or tuple."""

NUMBERS = (bool, int, float, np.number)


@cache
def code_digest() -> str:
    """What tells this version of the solver from every other: a state is restored by the code that computed it."""
    digest = hashlib.sha256(kernels_digest().encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def saved(root: object) -> Saved:
    """A copy of all arrays and numbers in `root`. Raises TypeError where it holds what is neither, nor fixed."""
    state: Saved = {}
    _save(root, "", state, set())
    return state


def restore(root: object, values: Mapping[str, Any]) -> None:
    """Give `root`, made from the same scene, the values that were saved. Raises ValueError if any is left over."""
    unused = set(values)
    _restore(root, "", values, unused, set())
    if unused:
        raise ValueError(f"not a checkpoint of this run: nothing here is called {min(unused)}")


def _save(value: object, path: str, state: Saved, visited: set[int]) -> None:
    if value is None or isinstance(value, NUMBERS):
        state[path] = value.item() if isinstance(value, np.number) else value
    elif isinstance(value, np.ndarray):
        state[path] = value.copy()
    elif _is_record(value):
        for name in value._fields:  # type: ignore[attr-defined]
            _save(getattr(value, name), f"{path}.{name}", state, visited)
    elif isinstance(value, (list, tuple)):
        state[f"{path}[]"] = len(value)
        for i, item in enumerate(value):
            _save(item, f"{path}[{i}]", state, visited)
    elif _is_ours(value):
        if id(value) not in visited:
            visited.add(id(value))
            for name in sorted(vars(value)):
                _save(getattr(value, name), f"{path}.{name}", state, visited)
    elif not (isinstance(value, str) or _is_frozen(value) or callable(value)):
        raise TypeError(f"{path} is a {type(value).__name__}, which a checkpoint cannot hold")


def _restore(value: Any, path: str, values: Mapping[str, Any], unused: set[str], visited: set[int]) -> Any:
    """The value that stands at `path` now: `value` itself, changed in place, wherever that can be."""
    if path in unused:
        unused.remove(path)
        new = values[path]
        if isinstance(value, np.ndarray) and value.shape == np.shape(new):
            value[...] = new
            return value
        return new
    if _is_record(value):
        parts = {name: _restore(part, f"{path}.{name}", values, unused, visited) for name, part in _parts(value)}
        same = all(parts[name] is part for name, part in _parts(value))
        return value if same else value._replace(**parts)
    if f"{path}[]" in unused:
        return _sequence(value, path, values, unused, visited)
    if _is_ours(value) and id(value) not in visited:
        visited.add(id(value))
        for name in sorted(_names_below(path, unused) | set(vars(value))):
            part = getattr(value, name, None)
            new = _restore(part, f"{path}.{name}", values, unused, visited)
            if new is not part:
                setattr(value, name, new)
    return value


def _sequence(value: Any, path: str, values: Mapping[str, Any], unused: set[str], visited: set[int]) -> Any:
    unused.remove(f"{path}[]")
    old = list(value) if isinstance(value, (list, tuple)) else []
    items = [
        _restore(old[i] if i < len(old) else None, f"{path}[{i}]", values, unused, visited)
        for i in range(values[f"{path}[]"])
    ]
    return items if isinstance(value, list) else tuple(items)


def _parts(record: Any) -> list[tuple[str, Any]]:
    return [(name, getattr(record, name)) for name in record._fields]


def _names_below(path: str, names: set[str]) -> set[str]:
    """The attributes that the names tell of: some come into being while a run goes on."""
    before = f"{path}."
    return {name[len(before):].split(".")[0].split("[")[0] for name in names if name.startswith(before)}


def _is_record(value: object) -> bool:
    return isinstance(value, tuple) and hasattr(value, "_fields")


def _is_ours(value: object) -> bool:
    """Whether it may change while a run goes on: an object of the solver that is not frozen."""
    return type(value).__module__.startswith("solver.") and hasattr(value, "__dict__") and not _is_frozen(value)


def _is_frozen(value: object) -> bool:
    return is_dataclass(value) and bool(getattr(value, "__dataclass_params__").frozen)  # noqa: B009  # not in the stubs
