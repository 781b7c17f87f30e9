"""Cases, put together."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from typing_extensions import Self

from hockle_client.schema import CaseSpec, Setting


@dataclass(frozen=True)
class Case:
    """A case, and values to change in it. Each change gives another case; the server looks at all of it."""

    base: str | Mapping[str, Any]
    settings: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def shipped(cls, name: str) -> Self:
        """A case that comes with hockle, by its name: `Client.shipped()` lists them."""
        return cls(name)

    @classmethod
    def of(cls, case: CaseSpec | Mapping[str, Any]) -> Self:
        """A whole case, as in its file."""
        return cls({**case})

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """A case from its file. Raises OSError, ValueError."""
        case = json.loads(Path(path).read_text(encoding="utf-8"))
        if not isinstance(case, dict):
            raise ValueError(f"{path} must hold a JSON object")
        return cls(case)

    def set(self, key: Setting | str, value: Any) -> Self:
        """The case with one value changed, by its dotted key: `numerics.intervals`, `loads.point.0.s`."""
        return self.with_settings({key: value})

    def with_settings(self, settings: Mapping[str, Any]) -> Self:
        """The case with several values changed."""
        return type(self)(self.base, {**self.settings, **settings})


CaseLike = Case | CaseSpec | Mapping[str, Any] | str
"""A case, its JSON data, or the name of a shipped one."""


def request_of(case: CaseLike, settings: Mapping[Any, Any], **more: Any) -> bytes:
    """The body that asks for a case to be run or looked at. Raises ValueError for what is no finite JSON."""
    changed = case_with(case, settings)
    return encoded({"case": changed.base, "set": dict(changed.settings), **more})


def case_with(case: CaseLike, settings: Mapping[Any, Any]) -> Case:
    """A case in any of its forms, with some values changed."""
    base = case if isinstance(case, Case) else Case(case if isinstance(case, str) else {**case})
    return base.with_settings(settings)


def encoded(body: Mapping[str, Any]) -> bytes:
    """A body as JSON. Raises ValueError for a number that is not finite, with where it stands; TypeError."""
    try:
        return json.dumps(body, default=plain, allow_nan=False).encode()
    except ValueError:
        lost = json.loads(json.dumps(body, default=plain), parse_constant=_Lost)
        raise next(_faults(lost, ""), ValueError("a case must have no circle in it")) from None


class _Lost(str):
    """NaN, Infinity or -Infinity."""


def _faults(value: Any, place: str) -> Iterator[ValueError]:
    if isinstance(value, _Lost):
        yield ValueError(f"{place} must be a finite number, got {value}")
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, entry in entries:
        yield from _faults(entry, f"{place}/{name}")


def plain(value: Any) -> Any:
    """Numbers and arrays of numpy, and the like of pandas, polars and Python, as JSON can write them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "to_list"):  # polars
        return value.to_list()
    if isinstance(value, range):
        return list(value)
    raise TypeError(f"a case holds plain JSON data, got {value!r} of type {type(value).__name__}")
