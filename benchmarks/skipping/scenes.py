"""Scenes that lack what could be left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import Scene


def _scene(case: str, settings: dict[str, Any], method: str) -> Scene:
    changed = apply_settings(load_case(case), settings | {"numerics.method": method})
    return build_scene(parse_case(changed))


def _before_contact(intervals: int, method: str) -> Scene:
    """goyal-2003 as shipped, as long as its total curvature rules contact out (it touches itself at 28 s)."""
    return _scene("goyal-2003", {"t_end": 15.0, "numerics.intervals": intervals}, method)


def _vacuum(intervals: int, method: str) -> Scene:
    """A curled rod that flies: no fluid, no contact, no loads."""
    scene = _scene("free-flight", {"numerics.intervals": intervals}, method)
    return replace(scene, topology=False)


SCENES: dict[str, Callable[[str], Scene]] = {
    **{f"goyal-2003 to 15 s, N = {n}": partial(_before_contact, n) for n in (100, 400)},
    **{f"free-flight, N = {n}": partial(_vacuum, n) for n in (100, 400)},
}
