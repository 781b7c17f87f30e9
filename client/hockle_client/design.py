"""What differs between the members of an ensemble."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
"""By dotted key: values (also numpy's), a Range, or what the service takes for one. No narrower type: a dictionary of
both kinds, kept in a variable, is one of objects to a type checker."""


def sweep_request(case: CaseLike, settings: Mapping[Any, Any], parameters: Parameters,
                  members: Sequence[Mapping[str, Any]], *, sample: Method | None, size: int | None, seed: int,
                  **more: Any) -> bytes:
    """The body that asks for an ensemble. Raises ValueError for what is no finite JSON."""
    changed = case_with(case, settings)
    body: dict[str, Any] = {"case": changed.base, "set": dict(changed.settings), **more}
    body["parameters"] = {name: asdict(values) if isinstance(values, Range) else values
                          for name, values in parameters.items()}  # fmt: skip
    if members:
        body["members"] = [dict(member) for member in members]
    if sample is not None:
        body["sample"] = {"method": sample, "size": size, "seed": seed}
    return encoded(body)
