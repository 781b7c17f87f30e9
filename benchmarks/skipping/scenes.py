"""Scenes that lack what could be left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from service.cases.build import build_scene
from service.cases.library import apply_settings, load_case, parse_case
from solver import FIXED, FREE, Condition, Curve, End, Fluid, Initial, Numerics, Rod, Scene
from solver.arrays import Array

LENGTH = 1.0


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


def _released(intervals: int, method: str) -> Scene:
    """An arc that springs back within its plane, clamped at one end, in still water."""
    rod = Rod.circular(LENGTH, 0.01, 1.25e7, 5e6, 1500.0)
    numerics = Numerics(method, intervals=intervals, dt_max=0.05)  # type: ignore[arg-type]
    return Scene(rod, Initial(_arc), End.clamp(), End.free(), 0.2, 0.02, gravity=(0.0, 0.0, -9.81),
                 fluid=Fluid(1000.0, 1.0, 1.2, 0.01), numerics=numerics, topology=False)  # fmt: skip


def _twisted(intervals: int, method: str) -> Scene:
    """A straight rod whose end, free to slide, is turned about its tangent to and fro."""
    turned = Curve.table([0.0, 0.5, 1.5, 2.0], [0.0, 4.0, -4.0, 0.0], "smoothstep")
    end = End((FIXED, FIXED, FREE), (FIXED, FIXED, (Condition("position", turned),)))
    scene = _released(intervals, method)
    return replace(scene, initial=Initial.straight(), end=end, t_end=2.0, output_interval=0.1)


def _arc(s: Array) -> Array:
    """A circular arc of 2 rad in the e1-e3 plane that starts along e3."""
    angle, radius = 2.0 * s / LENGTH, 0.5 * LENGTH
    return np.column_stack([radius * (1.0 - np.cos(angle)), np.zeros_like(s), radius * np.sin(angle)])


SCENES: dict[str, Callable[[str], Scene]] = {
    **{f"goyal-2003 to 15 s, N = {n}": partial(_before_contact, n) for n in (100, 400)},
    **{f"free-flight, N = {n}": partial(_vacuum, n) for n in (100, 400)},
}
"""Scenes in space."""

ONE_AXIS: dict[str, Callable[[str], Scene]] = {
    **{f"arc let go in its plane, N = {n}": partial(_released, n) for n in (100, 400)},
    **{f"twisted straight rod, N = {n}": partial(_twisted, n) for n in (100, 400)},
}
"""Scenes that turn about one axis."""
