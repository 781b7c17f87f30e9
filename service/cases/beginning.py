"""How long two cases are the same run: what differs only later need not be computed twice.

A run steps exactly onto its frames and onto the points of its schedules, so that its state at a frame depends on
nothing that comes after. docs/decisions/0022-shared-beginnings.md says what that leaves out.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf
from typing import Any

from service.cases.case import CaseSpec
from service.cases.ends import EndObject

FOR_PEOPLE = ("name", "title", "description")
LOCAL = ("linear", "smoothstep")
"""Interpolations in which a point says nothing of the intervals before the one that it ends."""


WORTH = 0.25
"""Part of a run that another one must have in common with it to wait for its end."""


@dataclass(frozen=True)
class Beginning:
    """The case (by its number) with which another one begins, and the last frame that they have in common."""

    leader: int
    frame: int


def shared_beginnings(specs: Sequence[CaseSpec]) -> list[Beginning | None]:
    """With which of the others each case begins; None for those that begin by themselves, or are begun with."""
    groups: dict[str, list[int]] = {}
    for number, spec in enumerate(specs):
        groups.setdefault(json.dumps(_trunk(_of_run(spec)), sort_keys=True), []).append(number)
    beginnings: list[Beginning | None] = [None] * len(specs)
    for group in groups.values():
        for number, frame in _begun_in(group, specs).items():
            beginnings[number] = frame
    return beginnings


def _begun_in(group: Sequence[int], specs: Sequence[CaseSpec]) -> dict[int, Beginning]:
    """Who of a group begins with the one that has most in common with the others."""
    best: dict[int, Beginning] = {}
    for leader in {group[0], group[-1], max(group, key=lambda number: specs[number].t_end)}:
        common = {number: common_frame(specs[leader], specs[number]) for number in group if number != leader}
        followers = {number: Beginning(leader, frame) for number, frame in common.items()
                if frame >= max(1.0, WORTH * specs[number].frames)}  # fmt: skip
        best = max(best, followers, key=lambda group: sum(beginning.frame for beginning in group.values()))
    return best


def _trunk(data: Any, name: str = "") -> Any:
    """What cases with one beginning have alike: a schedule is where it starts from, what comes later is left out."""
    if name in ("t_end", "switches"):
        return None
    if _is_schedule(data):
        return data["value"][0]
    if isinstance(data, dict):
        return {key: _trunk(value, key) for key, value in data.items()}
    return [_trunk(value) for value in data] if isinstance(data, list) else data


def common_frame(first: CaseSpec, then: CaseSpec) -> int:
    """The number of the last frame before anything of `then` differs from `first`; 0 where it has none to begin from.

    Neither's last frame counts: a run judges itself there.
    """
    if hindrance(first, then):
        return 0
    until = _same_until(_of_run(first), _of_run(then))
    if until == 0.0:
        return 0
    interval = then.output.interval
    last = min(first.frames, then.frames) - 2
    return max(0, last if until == inf else min(last, ceil(until / interval * (1 - 1e-12)) - 1))


def hindrance(first: CaseSpec, then: CaseSpec) -> str:
    """Why a run by `then` cannot begin with one by `first`, however alike they begin; empty where it can."""
    if then.analysis == "static":
        return "of a static analysis no states are kept"
    if then.contact is not None and then.contact.k1 is None and (first.ends, first.loads) != (then.ends, then.loads):
        return "the law of contact follows from all that the ends will do; with contact.k1 it does not"
    stored = set(first.output.fields) >= set(then.output.fields) or then.numerics.tolerance is not None
    if not (stored and first.output.interval == then.output.interval
            and first.output.topology == then.output.topology):  # fmt: skip
        return "its output has other frames, or variables that the other lacks"
    return ""


def _of_run(spec: CaseSpec) -> dict[str, Any]:
    """What the run depends on."""
    data = spec.model_dump(mode="json", exclude={*FOR_PEOPLE, "output"})
    for name, end in data["ends"].items():
        if isinstance(end, str):
            data["ends"][name] = EndObject.model_validate({"preset": end}).model_dump(mode="json")
    return data


def _same_until(first: Any, then: Any, name: str = "") -> float:
    """The time (s) until which two parts of cases say the same."""
    if first == then:
        return inf
    if name == "t_end":
        return float(min(first, then))
    if name == "switches":
        return _switched(first or [], then or [])
    if _is_schedule(first) or _is_schedule(then):
        return _schedules(first, then)
    if isinstance(first, dict) and isinstance(then, dict):
        keys = first.keys() | then.keys()
        return min(_same_until(first.get(key), then.get(key), key) for key in keys)
    if isinstance(first, list) and isinstance(then, list) and len(first) == len(then):
        return min(_same_until(a, b) for a, b in zip(first, then, strict=True))
    return 0.0


def _switched(first: list[Any], then: list[Any]) -> float:
    """Until the first switch that only one of two ends has, or that they have otherwise."""
    for a, b in zip(first, then, strict=False):
        if a != b:
            return float(min(a["at"], b["at"]))
    longer = max(first, then, key=len)
    return float(longer[min(len(first), len(then))]["at"])


def _is_schedule(value: Any) -> bool:
    return isinstance(value, dict) and "t" in value


def _schedules(first: Any, then: Any) -> float:
    """Until the last point that two functions of time have in common, or until one that is constant changes."""
    if not (_is_schedule(first) and _is_schedule(then)):
        table, constant = (first, then) if _is_schedule(first) else (then, first)
        return float(max(table["t"][0], 0.0)) if table["value"][0] == constant else 0.0
    if first["interpolation"] != then["interpolation"] or first["interpolation"] not in LOCAL:
        return 0.0
    until = 0.0
    for a, b in zip(zip(first["t"], first["value"], strict=True), zip(then["t"], then["value"], strict=True),
                    strict=False):  # fmt: skip
        if a != b:
            return until
        until = max(a[0], 0.0)
    return until
