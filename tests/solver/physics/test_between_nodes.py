"""What a rod has between the nodes of a mesh: loads, masses, necks and kinks that are narrower than an interval."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import Curve, DistributedLoad, End, Frame, Initial, Numerics, Rod, Scene, simulate
from solver.methods.space.one_axis.axis import axis_of
from solver.scene.rod import Profile

LENGTH, EJ, FORCE = 1.0, 10.0, 0.5
FLAT = Initial.straight((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), a1=(0.0, 1.0, 0.0))
NONE = Curve.constant(0.0)
PLACES = (0.2631, 0.5, 0.5937, 0.9687)
WIDTH = 0.01


def patch(middle: float, inside: float, outside: float = 0.0, width: float = WIDTH) -> Curve:
    """The value inside a part of the rod, and outside."""
    start, end = middle - 0.5 * width, middle + 0.5 * width
    return Curve.table([start - 1e-9, start, end, end + 1e-9], [outside, inside, inside, outside])


def cantilever(method: str = "static", intervals: int = 16, stiffness: Profile | None = None, **more: Any) -> Scene:
    bending: Profile = stiffness or Curve.constant(EJ)
    constant = Curve.constant
    inertia = constant(1e-6), constant(1e-6), constant(2e-6)
    rod = Rod(LENGTH, (bending, bending, constant(EJ)), constant(0.1), inertia, constant(0.02))
    static = method == "static"
    numerics = Numerics(method="staggered" if static else method, intervals=intervals)
    scene = Scene(rod, FLAT, End.clamp(), End.free(), t_end=4.0, output_interval=4.0, damping=4.0, numerics=numerics)
    return replace(scene, **more, analysis="static" if static else "dynamic")


def last(scene: Scene) -> Frame:
    *_, frame = simulate(scene)
    return frame


def load(middle: float, frame: Any = "lab") -> DistributedLoad:
    across = patch(middle, FORCE / WIDTH)
    # in the rod's frame a1 is e2 and a2 is e3
    return DistributedLoad((NONE, NONE, across) if frame == "lab" else (NONE, across, NONE), frame=frame)


@pytest.mark.parametrize("frame", ["lab", "material"])
@pytest.mark.parametrize("method", ["static", "staggered", "box"])
@pytest.mark.parametrize("middle", PLACES)
def test_a_narrow_load_acts_with_all_its_force_where_it_is(method: str, middle: float, frame: str) -> None:
    rest = last(cantilever(method, distributed=(load(middle, frame),)))
    deflection = FORCE * middle**2 * (3.0 * LENGTH - middle) / (6.0 * EJ)
    at_root = np.linalg.norm(rest.f[0])
    assert at_root == pytest.approx(FORCE, rel=2e-3)
    # where no segments are, it acts on a node
    assert rest.r[-1, 2] == pytest.approx(deflection, rel=0.1 if method == "box" else 0.02)


@pytest.mark.parametrize("method", ["static", "staggered", "box"])
@pytest.mark.parametrize("middle", PLACES)
def test_a_narrow_mass_weighs_what_it_weighs(method: str, middle: float) -> None:
    scene = cantilever(method, gravity=(0.0, 0.0, -1.0))
    heavy = replace(scene, rod=replace(scene.rod, mass=patch(middle, 100.0, 0.1)))
    assert np.linalg.norm(last(heavy).f[0]) == pytest.approx(0.1 + 99.9 * WIDTH, rel=2e-3)


@pytest.mark.parametrize("method", ["static", "staggered"])
@pytest.mark.parametrize("middle", PLACES[:-1])
def test_a_narrow_neck_gives_way(method: str, middle: float) -> None:
    loads = (DistributedLoad((NONE, NONE, Curve.constant(FORCE)), frame="lab"),)
    stiff, neck = (last(cantilever(method, stiffness=EJ_, distributed=loads)).r[-1, 2]
                   for EJ_ in (None, patch(middle, 0.01 * EJ, EJ)))  # fmt: skip
    arm = LENGTH - middle
    # on 16 intervals it bends in a joint up to half an interval beside it, which changes the arm by that much
    expected = 0.5 * FORCE * arm**2 * (99.0 / EJ) * WIDTH * arm  # what the neck turns by, times the way to the tip
    assert neck - stiff == pytest.approx(expected, rel=0.12)


@pytest.mark.parametrize("method", ["static", "staggered", "box"])
@pytest.mark.parametrize("middle", PLACES[:-1])
def test_beside_a_step_the_curvature_is_that_of_the_section_there(method: str, middle: float) -> None:
    stepped = patch(middle, 0.1 * EJ, EJ, 0.2)
    loads = (DistributedLoad((NONE, NONE, Curve.constant(FORCE)), frame="lab"),)
    rest = last(cantilever(method, stiffness=stepped, distributed=loads))
    s = np.linspace(0.0, LENGTH, len(rest.r))
    assert np.abs(rest.kappa[:, 0]).max() > 0.01
    assert rest.kappa[:, 0] == pytest.approx(rest.q[:, 0] / stepped(s), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("method", ["static", "staggered", "box"])
@pytest.mark.parametrize("middle", PLACES[:-1])
def test_beside_a_step_of_kappa0_the_curvature_is_that_of_its_place(method: str, middle: float) -> None:
    scene, bent = cantilever(method), patch(middle, 0.3, 0.0, 0.2)
    rest = last(replace(scene, rod=replace(scene.rod, kappa0=(NONE, bent, NONE))))
    s = np.linspace(0.0, LENGTH, len(rest.r))
    assert rest.kappa[:, 1] == pytest.approx(rest.q[:, 1] / EJ + bent(s), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("method", ["staggered", "box"])
def test_at_the_start_the_curvature_is_that_of_the_shape_as_given(method: str) -> None:
    scene = cantilever(method, stiffness=patch(0.5937, 0.1 * EJ, EJ, 0.2))
    bent = replace(scene.rod, kappa0=(NONE, patch(0.5937, 0.3, 0.0, 0.2), NONE))
    assert np.abs(next(iter(simulate(replace(scene, rod=bent)))).kappa).max() == 0.0


@pytest.mark.parametrize("middle", PLACES[:-1])
def test_a_natural_kink_turns_by_its_angle(middle: float) -> None:
    scene = cantilever()
    kinked = replace(scene, rod=replace(scene.rod, kappa0=(NONE, patch(middle, 0.1 / WIDTH), NONE)))
    rest = last(kinked)
    along = rest.r[-1] - rest.r[-2]
    assert abs(np.arctan2(np.linalg.norm(along[1:]), along[0])) == pytest.approx(0.1, rel=1e-6)


def test_a_narrow_load_is_told_from_none_by_a_tolerance() -> None:
    scene = replace(cantilever("staggered", distributed=(load(0.5),)), numerics=Numerics("staggered", tolerance=1e-3))
    frame = last(scene)
    assert frame.r[-1, 2] == pytest.approx(FORCE * 0.25 * 2.5 / (6.0 * EJ), rel=2e-3)


@pytest.mark.parametrize("middle", [0.5781, 0.61])
def test_a_narrow_load_or_kink_out_of_the_plane_leaves_no_plane(middle: float) -> None:
    scene = cantilever("staggered", gravity=(0.0, 0.0, -1.0))
    across = DistributedLoad((NONE, patch(middle, FORCE / WIDTH), NONE))
    kinked = replace(scene.rod, kappa0=(NONE, patch(middle, 0.1 / WIDTH), NONE))
    view = replace(scene, numerics=Numerics("staggered", intervals=16))
    assert axis_of(view) is not None
    assert axis_of(replace(view, distributed=(across,))) is None
    assert axis_of(replace(view, rod=kinked)) is None
