"""All loads there are: one line each."""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from solver.kernels.dispatch import enter
from solver.physics.loads import added_mass, damping, dead, drag, following, levers, sheared_drag, solids, user, weight
from solver.physics.loads import load as protocol
from solver.physics.loads.load import Samples, Source, has_energy
from solver.scene.scene import Scene

LOADS: tuple[Any, ...] = (
    weight,
    dead,
    following,
    levers,
    damping,
    added_mass,
    drag,
    sheared_drag,
    solids,
    *user.KINDS,
)


def _name(load: Any) -> str:
    return str(load.__name__.rsplit(".", 1)[-1])


ABOUT = tuple(load for load in LOADS if hasattr(load, "about"))
"""Those that a scene which turns about one axis may have."""

Loads = namedtuple("Loads", [_name(load) for load in LOADS])  # type: ignore[misc]
LoadsAbout = namedtuple("LoadsAbout", [_name(load) for load in ABOUT])  # type: ignore[misc]


for _load in LOADS:
    if not (hasattr(_load, "account") or hasattr(_load, "energy")):
        raise TypeError(f"{_load.__name__} must say what becomes of its power, by account or energy")
    enter(protocol, (_load.Record,), _load)


def sources_of(scene: Scene, samples: Samples) -> tuple[Source, ...]:
    """Each load of a scene, present or absent, sampled where a method wants it.

    Raises TypeError for one of which no law is known.
    """
    for source in scene.loads:
        if not any(isinstance(source, load.Given) for load in LOADS if hasattr(load, "Given")):
            raise TypeError(f"a load must be of a kind that physics.loads.registry lists, got {source!r}")
    return tuple(load.of(scene, samples) for load in LOADS)


def records_with_energy(records: Any) -> Any:
    """The same records, but only those of loads that store energy are present."""
    others = {name: record for name, record in records._asdict().items() if not has_energy(type(record))}
    return records._replace(**{name: record._replace(present=False) for name, record in others.items()})


def records_about(axis: Any, sources: tuple[Source, ...]) -> Any:
    """Their records in the plane of an axis. Raises ValueError for a load that has none there."""
    records = {}
    for load, source in zip(LOADS, sources, strict=True):
        if hasattr(load, "about"):
            records[_name(load)] = load.about(source.record, axis)
        elif source.record.present:
            raise ValueError(f"{_name(load)} does not turn about one axis")
    return LoadsAbout(**records)


def about_axis(sources: tuple[Source, ...], records: Any) -> list[tuple[Any, Source, Any]]:
    """Each load that may turn about one axis, with its source and its record there, of the `records_about` it."""
    pairs = [(load, source) for load, source in zip(LOADS, sources, strict=True) if load in ABOUT]
    return [(*pair, record) for pair, record in zip(pairs, records, strict=True)]


def entrained_mass(sources: tuple[Source, ...]) -> Any:
    """The mass per length (n,) that the loads let the rod take along across its tangent, kg/m."""
    masses = [source.record.mass for load, source in zip(LOADS, sources, strict=True) if hasattr(load, "entrained")]
    return sum(masses)
