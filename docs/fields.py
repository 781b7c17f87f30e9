"""The fields of a JSON schema as rows: name, default, unit, range, meaning."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import groupby
from typing import Any

from docs.markers import markdown

Schema = dict[str, Any]
HEAD = ("field", "default", "unit", "range", "meaning")
AXES = {(1, 0, 0): "e1", (0, 1, 0): "e2", (0, 0, 1): "e3"}


def fields_table(*parts: Schema, label: Callable[[str], str] = str) -> str:
    """The fields of a part; of several parts that are alternatives, those that only one has say so.

    `label`: what the reader calls a field. Neighbours that differ by their names only share a row.
    """
    rows = [(name, *_row(name, parts)) for name in dict.fromkeys(name for part in parts for name in part["properties"])]
    return markdown(HEAD, [
        [", ".join(f"`{label(row[0])}`" for row in same), *rest] for rest, same in groupby(rows, lambda row: row[1:])
    ])  # fmt: skip


def _row(name: str, parts: tuple[Schema, ...]) -> tuple[str, ...]:
    having = [part for part in parts if name in part["properties"]]
    field = having[0]["properties"][name]
    default = "required" if name in having[0].get("required", ()) else default_of(field)
    only = "" if len(having) == len(parts) else f"{having[0]['title'].lower()}: "
    values = list(dict.fromkeys(text for part in having if (text := range_of(part["properties"][name]))))
    return default, field.get("unit", ""), " or ".join(values), only + field["description"]


def default_of(field: Schema) -> str:
    """Its default in words."""
    default = field["default"]
    if default is None or default in ([], {}):
        return "none"
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, str):
        return f"`{default}`" if default else "empty"
    if isinstance(default, list):
        return _list(default, field)
    if isinstance(default, dict):
        return "none"
    return _number(default)


def _list(default: list[Any], field: Schema) -> str:
    if default == field.get("items", {}).get("enum"):
        return "all"
    return "0" if not any(default) else AXES[tuple(default)]


def range_of(field: Schema) -> str:
    """The rule for a field's value, or for each number in it."""
    values = field.get("enum") or field.get("items", {}).get("enum") or [field.get("const")]
    if values != [None]:
        return ", ".join(f"`{value}`" for value in values)
    if "maxItems" in field and "prefixItems" not in field:
        least = f"{field['minItems']} to " if "minItems" in field else "up to "
        return f"{least}{field['maxItems']:,} entries"
    bounds = list(dict.fromkeys(bound for bound in map(_bound, _numbers(field)) if bound))
    return " or ".join(bounds)


def _numbers(schema: Schema) -> Iterator[Schema]:
    """What the schema says of numbers in it, but not in other parts."""
    if schema.get("type") in ("number", "integer"):
        yield schema
    for kind in ("anyOf", "oneOf", "prefixItems"):
        for choice in schema.get(kind, ()):
            yield from _numbers(choice)


def _bound(number: Schema) -> str:
    least, most = number.get("minimum"), number.get("maximum")
    if least is not None and least == most:
        return _number(least)
    if least is not None and most is not None:
        return f"{_number(least)} to {_number(most)}"
    signs = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    return ", ".join(f"{sign} {_number(number[name])}" for name, sign in signs.items() if name in number)


def _number(value: float) -> str:
    if isinstance(value, int) or value.is_integer():
        text = f"{int(value):,}" if abs(value) >= 10_000 else str(int(value))
    else:
        text = f"{value:g}"
    return text.replace("-", "−") if value < 0 else text.replace("e-0", "e-")
