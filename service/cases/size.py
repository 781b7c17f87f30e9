"""How large a case would be in memory and in steps; what is too large is refused before anything is built."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from service.cases.errors import refusal
from service.cases.quantities import ProfileTable, ScheduleTable
from solver.physics.contact.recipe import IN_MOTION
from solver.run.trial import FIRST_INTERVALS

if TYPE_CHECKING:
    from service.cases.case import CaseSpec

MOST_NODE_FRAMES = 10_000_000
"""Nodes times stored frames: about 1.8 GB before compression."""
MOST_STEPS = 10_000_000
"""Steps at dt_max; the run may need more, where it has to refine."""
MOST_CONTACT_POINTS = 1_000_000
"""About 250 MB."""
MOST_CONTACT_PAIRS = 20_000_000
"""Of points within the cutoff of each other, where strands lie side by side all along."""
MOST_TABLE_POINTS = 200_000
"""Of all tables together: about 30 MB, and where they are schedules as many steps that end on them."""
TABLES: tuple[type, ...] = (ProfileTable, ScheduleTable)
PLAIN = frozenset({float, int, str, bool, type(None)})
"""What holds no table."""


def refuse_large(case: CaseSpec) -> None:
    """Raise a refusal that names the field, its value and the rule."""
    _refuse_output(case)
    _refuse_contact(case)
    _refuse_tables(case)


def contact_points(case: CaseSpec) -> tuple[float, float]:
    """How many contact points there are, and how many pairs of them may feel each other."""
    spacing, cutoff = _spacing(case), _cutoff(case)
    points = case.rod.length / spacing + 1.0 if spacing else 0.0
    return points, points * cutoff / spacing if spacing else 0.0


def tables_in(part: object, pointer: str = "") -> list[tuple[str, ProfileTable | ScheduleTable]]:
    """Every table below a part of a case, and where it is."""
    tables: list[tuple[str, ProfileTable | ScheduleTable]] = []
    for name, inner in enumerate(part) if isinstance(part, tuple) else vars(part).items():
        kind = type(inner)  # most hold none, and pydantic's classes are slow to ask
        if kind in TABLES:
            tables.append((f"{pointer}/{name}", inner))
        elif kind not in PLAIN:
            tables += tables_in(inner, f"{pointer}/{name}")
    return tables


def _refuse_output(case: CaseSpec) -> None:
    if case.output.interval > case.t_end:
        raise refusal("output/interval", case.output.interval, f"must be <= t_end ({case.t_end} s)")
    frames = case.t_end / case.output.interval
    stored = inf if frames > MOST_NODE_FRAMES else case.frames * ((case.numerics.intervals or FIRST_INTERVALS) + 1)
    if stored > MOST_NODE_FRAMES:
        count = f"{frames:.3g} frames" if stored == inf else f"{stored:,}"
        rule = f"must leave at most {MOST_NODE_FRAMES:,} nodes times frames, not {count}"
        raise refusal("output/interval", case.output.interval, rule)
    steps = case.t_end / (case.numerics.dt_max or case.output.interval)
    if case.analysis == "dynamic" and steps > MOST_STEPS:
        rule = f"must leave at most {MOST_STEPS:,} steps, not {steps:,.0f}"
        raise refusal("numerics/dt_max", case.numerics.dt_max, rule)


def _refuse_contact(case: CaseSpec) -> None:
    if case.contact is None:
        return
    points, pairs = contact_points(case)
    default = f" (of {_spacing(case):g} m, 0.4 diameters)" if case.contact.spacing is None else ""
    if points > MOST_CONTACT_POINTS:
        rule = f"must leave at most {MOST_CONTACT_POINTS:,} contact points along the rod{default}, not {points:,.0f}"
        raise refusal("contact/spacing", case.contact.spacing, rule)
    if pairs > MOST_CONTACT_PAIRS:
        rule = (f"must leave at most {MOST_CONTACT_PAIRS:,} pairs of contact points within the cutoff of "
                f"{_cutoff(case):g} m, not {pairs:,.0f}")
        raise refusal("contact/spacing", case.contact.spacing, rule)


def _refuse_tables(case: CaseSpec) -> None:
    lengths = {pointer: len(table.value) for pointer, table in tables_in(case)}
    if (many := sum(lengths.values())) > MOST_TABLE_POINTS:
        longest = max(lengths, key=lengths.__getitem__)
        rule = f"must leave at most {MOST_TABLE_POINTS:,} points in all tables of the case, not {many:,}"
        raise refusal(longest.removeprefix("/"), f"{lengths[longest]:,} points", rule)


def _spacing(case: CaseSpec) -> float:
    if case.contact is None:
        return 0.0
    return case.contact.spacing or IN_MOTION.spacing * min(_diameters(case))


def _cutoff(case: CaseSpec) -> float:
    if case.contact is None:
        return 0.0
    return case.contact.cutoff or (2.0 - IN_MOTION.pole) * max(_diameters(case))


def _diameters(case: CaseSpec) -> tuple[float, ...]:
    diameter = case.rod.diameter
    return diameter.value if isinstance(diameter, ProfileTable) else (diameter,)
