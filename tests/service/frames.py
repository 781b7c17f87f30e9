"""Frames without a simulation: every value tells its time, node and component."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from types import SimpleNamespace
from typing import Any

import numpy as np

from service.cases import CaseSpec, apply_settings, build_scene, load_case, parse_case
from solver import Frame, Statistics
from solver.measures.frame import Fields, complete

STATISTICS = Statistics(steps=12, newton_iterations=34, failed_steps=1, cpu_time=5.5)


def small_spec(**settings: Any) -> CaseSpec:
    """A shipped case with 10 intervals."""
    return parse_case(apply_settings(load_case("elastica"), {"numerics.intervals": 10, **settings}))


def nodes(spec: CaseSpec) -> np.ndarray:
    """The arclengths of a case's nodes."""
    return np.linspace(0.0, spec.rod.length, spec.numerics.intervals + 1)


def frames(spec: CaseSpec, count: int) -> Iterator[Frame]:
    """Frames at t = 0, 0.5, 1, ...; field k (of eight) is 100 k + t + s + component / 10."""
    s, scene, names = nodes(spec), build_scene(spec), [field.name for field in fields(Fields)]
    for i in range(count):
        t = 0.5 * i
        values = [100.0 * k + t + s[:, None] + np.arange(3 + (k == 6)) / 10 for k in range(7)] + [700.0 + t + s]
        frame = Frame(
            t=t, **dict(zip(names, values, strict=True)),
            energy_bending=t + 1, energy_torsion=t + 2, energy_stretching=0.0, energy_kinetic=t + 3,
            energy_added_mass=t + 4, energy_potential=t + 5, energy_contact=t + 6, work_ends=t + 7, work_loads=t + 8,
            dissipation=t + 9, energy_balance=t + 10, Tw=t + 11, Wr=np.nan, Lk=t + 13, min_gap=np.nan,
            contacts=i, dt=0.5, newton_iterations=2 * i,
        )  # fmt: skip
        yield complete(frame, s, scene)


def ended(spec: CaseSpec) -> SimpleNamespace:
    """What a writer asks of a run that has ended."""
    return SimpleNamespace(s=nodes(spec), statistics=STATISTICS, attributes=dict)
