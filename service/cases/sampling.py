"""Which values the members of an ensemble have: all combinations, or a sample of ranges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Method = Literal["latin_hypercube", "sobol", "saltelli"]
Values = tuple[Any, ...]
"""Those of one member, in the order of the parameters."""


@dataclass(frozen=True)
class Range:
    """From `low` up to `high`, evenly, or evenly in its logarithm."""

    low: float
    high: float
    logarithmic: bool = False

    def at(self, part: NDArray[np.float64]) -> NDArray[np.float64]:
        """The values at parts of the range, from 0 to 1."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** part
        return self.low + part * (self.high - self.low)


def grid(values: Sequence[Sequence[Any]]) -> list[Values]:
    """All combinations of the values of several parameters; the last one changes fastest."""
    return list(product(*values))


def size_of(method: Method, size: int, parameters: int) -> int:
    """How many members a sample of this size has."""
    return size * (parameters + 2) if method == "saltelli" else size


def sample(method: Method, ranges: Sequence[Range], size: int, seed: int) -> list[Values]:
    """Values that fill the ranges; the same seed gives the same ones.

    `latin_hypercube` and `sobol`: as scipy.stats.qmc has them. `saltelli`: the points from which Sobol's indices are
    estimated (Saltelli et al., 2010), size (parameters + 2) of them, as SALib has them.
    """
    parts = _unit(method, len(ranges), size, seed)
    columns = [bounds.at(part) for bounds, part in zip(ranges, parts.T, strict=True)]
    return list(zip(*(column.tolist() for column in columns), strict=True))


def _unit(method: Method, parameters: int, size: int, seed: int) -> NDArray[np.float64]:
    """Points of the unit cube (members, parameters)."""
    if method == "saltelli":
        from SALib.sample import sobol as saltelli  # with pandas and matplotlib, a second

        problem = unit_problem(parameters)
        points: NDArray[np.float64] = saltelli.sample(problem, size, calc_second_order=False, seed=seed)
        return points
    from scipy.stats import qmc  # half a second

    kind = {"latin_hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol}[method]
    drawn: NDArray[np.float64] = kind(parameters, rng=np.random.default_rng(seed)).random(size)
    return drawn


def unit_problem(parameters: int) -> dict[str, Any]:
    """So many parameters, each from 0 to 1, as SALib is told of them."""
    names = [str(number) for number in range(parameters)]
    return {"num_vars": parameters, "names": names, "bounds": [[0.0, 1.0]] * parameters}


@dataclass(frozen=True)
class Index:
    """A parameter's part of the variance of a number: by itself, and with all that it does together with others; and
    the half widths of their 95 % confidence intervals."""

    first: float
    first_confidence: float
    total: float
    total_confidence: float


def sobol_indices(values: NDArray[np.float64], parameters: int) -> list[Index]:
    """Sobol's indices of a number, by its values at the points of a `saltelli` sample (members,)."""
    from SALib.analyze import sobol

    indices: Mapping[str, NDArray[np.float64]] = sobol.analyze(
        unit_problem(parameters), values, calc_second_order=False, seed=0
    )
    columns = (indices[name].tolist() for name in ("S1", "S1_conf", "ST", "ST_conf"))
    return [Index(*row) for row in zip(*columns, strict=True)]
