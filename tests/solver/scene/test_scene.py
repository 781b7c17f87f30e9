"""What a scene refuses: each error names the field, the value and the rule."""

from __future__ import annotations

import re
from dataclasses import replace
from math import inf, nan, pi
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import Condition, Contact, Curve, End, Fluid, Initial, Numerics, PointLoad, Rod, Scene
from solver.physics.loads.solids import Floor
from solver.scene.ends import FIXED, FREE

CONTACT = Contact(k1=1e-7, k2=3.0, k3=1e-6, k4=1.0, aperture=1.0, cutoff=0.1, skip=0.3, spacing=0.05)
FLUID = Fluid(density=1000.0)
SCENE = Scene(
    rod=Rod.circular(2.0, 0.01, 1e7, 5e6, 1500.0),
    initial=Initial.straight(),
    start=End.clamp(),
    end=End.free(),
    t_end=1.0,
    output_interval=0.1,
)


@pytest.mark.parametrize(
    ("field", "value", "rule"),
    [
        *(("t_end", t, "> 0 s") for t in (0.0, -1.0, nan, inf)),
        *(("output_interval", t, r"in \(0, t_end\]") for t in (0.0, -0.1, 1.5, nan)),
        *(("damping", c, ">= 0 1/s") for c in (-1.0, nan, inf)),
        *(("gravity", (0.0, 0.0, g), "finite") for g in (nan, inf)),
    ],
)
def test_a_scene_refuses(field: str, value: Any, rule: str) -> None:
    with pytest.raises(ValueError, match=f"^{field} must be {rule}, got {re.escape(str(value))}"):
        replace(SCENE, **{field: value})


@pytest.mark.parametrize("s", [-0.1, 2.1, nan])
def test_a_point_load_off_the_rod_is_refused(s: float) -> None:
    with pytest.raises(ValueError, match=rf"s of a point load must be in \[0, 2\.0\] m, got {s}"):
        replace(SCENE, points=(PointLoad(s),))


@pytest.mark.parametrize("s", [0.0, 2.0])
def test_a_force_that_follows_an_end_free_along_lab_axes_is_refused(s: float) -> None:
    free = replace(End.free(), frame="lab")
    push = PointLoad(s, force=(Curve.constant(1.0), Curve.constant(0.0), Curve.constant(0.0)), frame="material")
    with pytest.raises(ValueError, match="free along lab axes must be"):
        replace(SCENE, start=free, end=free, points=(push,))
    turning = PointLoad(s, moment=push.force, frame="material")
    for allowed in (replace(push, s=1.0), replace(push, frame="lab"), turning):
        replace(SCENE, start=free, end=free, points=(allowed,))
    replace(SCENE, start=free, end=free, points=(push,), analysis="static")


@pytest.mark.parametrize(
    ("field", "value", "rule"),
    [
        *(("intervals", n, "a whole number >= 2") for n in (1, 10.5, 10.0, nan, True)),
        *(("dt_max", dt, "> 0 s") for dt in (0.0, -0.1, nan, inf)),
        *(("rho_inf", rho, r"in \[0, 1\]") for rho in (-0.1, 1.1, nan)),
        *(("rho_inf_space", rho, r"in \[0, 1\]") for rho in (-0.1, 1.1, nan)),
        *(("increment_tolerance", x, "> 0") for x in (0.0, -1.0, nan)),
    ],
)
def test_numerics_refuse(field: str, value: Any, rule: str) -> None:
    with pytest.raises(ValueError, match=f"^{field} must be {rule}, got {value}"):
        replace(Numerics(), **{field: value})


def test_shooting_is_for_the_box_scheme_only() -> None:
    with pytest.raises(ValueError, match=r"rho_inf_space must be 1 with linear_solver shooting, got 0\.5"):
        Numerics(linear_solver="shooting", rho_inf_space=0.5)


@pytest.mark.parametrize("field", ["k1", "k2", "k3", "k4"])
@pytest.mark.parametrize("value", [-1e-9, nan, inf])
def test_contact_refuses_a_constant(field: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"contact {field} must be >= 0, got {value}"):
        replace(CONTACT, **{field: value})


@pytest.mark.parametrize("field", ["cutoff", "skip", "spacing"])
@pytest.mark.parametrize("value", [0.0, -1.0, nan, inf])
def test_contact_refuses_a_length(field: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"contact {field} must be > 0 m, got {value}"):
        replace(CONTACT, **{field: value})


@pytest.mark.parametrize("aperture", [0.0, -1.0, pi + 1e-6, nan])
def test_contact_refuses_an_aperture(aperture: float) -> None:
    with pytest.raises(ValueError, match=r"contact aperture must be in \(0, pi\] rad, got"):
        replace(CONTACT, aperture=aperture)


@pytest.mark.parametrize("field", ["density", "added_mass", "drag_normal", "drag_tangential"])
@pytest.mark.parametrize("value", [-1.0, nan, inf])
def test_a_fluid_refuses(field: str, value: Any) -> None:
    with pytest.raises(ValueError, match=f"fluid {field} must be >= 0, got {value}"):
        replace(FLUID, **{field: value})


@pytest.mark.parametrize("speed", [nan, inf, -inf])
def test_a_fluid_refuses_a_current(speed: float) -> None:
    with pytest.raises(ValueError, match=rf"fluid current must be finite, got \(1.0, {speed}, 0.0\)"):
        replace(FLUID, current=(1.0, speed, 0.0))


@pytest.mark.parametrize("field", ["velocity", "angular_velocity", "a1"])
def test_a_start_refuses(field: str) -> None:
    with pytest.raises(ValueError, match=rf"initial {field} must be finite, got \(0.0, {nan}, 1.0\)"):
        Initial.straight(**{field: (0.0, nan, 1.0)})


@pytest.mark.parametrize("within", [0.0, -0.1, nan])
def test_a_stop_needs_time(within: float) -> None:
    with pytest.raises(ValueError, match=f"within must be > 0 s for a stop, got {within}"):
        Condition("stop", since=1.0, within=within)


@pytest.mark.parametrize("times", [(), (1.0,), (0.0, 0.0), (0.0, 2.0, 1.0)])
def test_conditions_must_start_at_zero_and_follow_each_other(times: tuple[float, ...]) -> None:
    component = tuple(Condition("rate", since=t) for t in times)
    with pytest.raises(ValueError, match=r"translation\[2\]: since must start at 0 and increase, got \["):
        End((FIXED, FIXED, component), (FIXED, FIXED, FIXED))
    with pytest.raises(ValueError, match=r"rotation\[0\]: since must start at 0 and increase, got \["):
        End((FIXED, FIXED, FIXED), (component, FIXED, FIXED))


def test_a_stop_needs_something_to_stop() -> None:
    stop = (Condition("stop", within=0.1),)
    with pytest.raises(ValueError, match=r"rotation\[1\]: a stop needs a condition before it"):
        End((FIXED, FIXED, FIXED), (FIXED, stop, FIXED))


def test_the_presets_hold_what_their_names_say() -> None:
    assert End.clamp() == End((FIXED, FIXED, FIXED), (FIXED, FIXED, FIXED))
    assert End.pin() == End((FIXED, FIXED, FIXED), (FREE, FREE, FREE))
    assert End.slider() == End((FIXED, FIXED, FREE), (FIXED, FIXED, FIXED))
    assert End.free() == End((FREE, FREE, FREE), (FREE, FREE, FREE))


def test_a_straight_rod_has_unit_tangents_whatever_its_direction() -> None:
    initial = Initial.straight(origin=(1.0, 2.0, 3.0), direction=(0.0, 3.0, 4.0))
    assert_allclose(initial.centreline(np.array([0.0, 5.0])), [[1.0, 2.0, 3.0], [1.0, 5.0, 7.0]])


@pytest.mark.parametrize("size", [1e200, 1e-200, 1e-320])
def test_a_direction_may_have_any_length(size: float) -> None:
    initial = Initial.straight(direction=(size, 0.0, -size))
    assert_allclose(initial.centreline(np.array([2.0])), [[2.0**0.5, 0.0, -(2.0**0.5)]])
    assert_allclose(Floor(stiffness=1.0, normal=(size, 0.0, -size)).up, [0.5**0.5, 0.0, -(0.5**0.5)])


def test_a_straight_rod_needs_a_direction() -> None:
    with pytest.raises(ValueError, match="direction must not be zero"):
        Initial.straight(direction=(0.0, 0.0, 0.0))


def test_a_condition_is_zero_unless_told() -> None:
    assert Condition("rate").curve.value(3.0) == 0.0
    assert Condition("load", Curve.constant(2.0)).curve.value(3.0) == 2.0
