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
        """A case that comes with hockle, by its name: `Client.shipped()` tells them."""
        return cls(name)

    @classmethod
    def of(cls, case: CaseSpec | Mapping[str, Any]) -> Self:
        """A whole case, as in its file."""
        return cls({**case})

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """A case from its file. Raises OSError, ValueError."""
        told = json.loads(Path(path).read_text(encoding="utf-8"))
        if not isinstance(told, dict):
            raise ValueError(f"{path} must hold a JSON object")
        return cls(told)

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
    asked = whole(case, settings)
    return written({"case": asked.base, "set": dict(asked.settings), **more})


def whole(case: CaseLike, settings: Mapping[Any, Any]) -> Case:
    """A case with some values changed, however it was given."""
    made = case if isinstance(case, Case) else Case(case if isinstance(case, str) else {**case})
    return made.with_settings(settings)


def written(body: Mapping[str, Any]) -> bytes:
    """A body as JSON. Raises ValueError for a number that is not finite, with where it stands; TypeError."""
    try:
        return json.dumps(body, default=plain, allow_nan=False).encode()
    except ValueError:
        lost = json.loads(json.dumps(body, default=plain), parse_constant=_Lost)
        raise next(_faults(lost, ""), ValueError("a case must have no circle in it")) from None


class _Lost(str):
    """NaN, Infinity or -Infinity."""


def _faults(told: Any, place: str) -> Iterator[ValueError]:
    if isinstance(told, _Lost):
        yield ValueError(f"{place} must be a finite number, got {told}")
    inside = told.items() if isinstance(told, dict) else enumerate(told) if isinstance(told, list) else ()
    for name, value in inside:
        yield from _faults(value, f"{place}/{name}")


def plain(value: Any) -> Any:
    """Numbers and arrays of numpy as JSON can write them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a case holds plain JSON data, got {value!r} of type {type(value).__name__}")
