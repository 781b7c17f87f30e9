"""What differs between the members of an ensemble."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

from hockle_client.case import CaseLike, case_with, encoded

Method = Literal["latin_hypercube", "sobol", "saltelli"]
Scale = Literal["linear", "log"]


@dataclass(frozen=True)
class Range:
    """A range that a sample fills, evenly or evenly in the logarithm."""

    low: float
    high: float
    scale: Scale = "linear"


Parameters = Mapping[str, Any]
"""By dotted key: values (also of numpy, pandas, polars), a Range, or what the service takes for one. No narrower type:
a dictionary of both kinds, kept in a variable, is one of objects to a type checker."""
Members = Any
"""Mappings with the values of each member, or a table of pandas or polars with a row for each."""


def sweep_request(case: CaseLike, settings: Mapping[Any, Any], parameters: Parameters,
                  members: Members, *, sample: Method | None, size: int | None, seed: int,
                  **more: Any) -> bytes:
    """The body that asks for an ensemble. Raises ValueError for what is no finite JSON."""
    changed = case_with(case, settings)
    body: dict[str, Any] = {"case": changed.base, "set": dict(changed.settings), **more}
    body["parameters"] = {name: asdict(values) if isinstance(values, Range) else values
                          for name, values in parameters.items()}  # fmt: skip
    if rows := _rows(members):
        body["members"] = rows
    if sample is not None:
        body["sample"] = {"method": sample, "size": size, "seed": seed}
    return encoded(body)


def _rows(members: Members) -> list[dict[str, Any]]:
    if hasattr(members, "to_dicts"):  # polars
        return list(members.to_dicts())
    if hasattr(members, "to_dict"):  # pandas
        return list(members.to_dict("records"))
    return [dict(member) for member in members]
