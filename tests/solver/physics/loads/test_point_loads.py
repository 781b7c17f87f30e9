"""Point loads within the rod: what a beam's theory has for them, wherever they are between the nodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver import FIXED, FREE, Curve, End, Initial, Numerics, PointLoad, Scene, simulate
from tests.solver.scenes import DIAMETER, EJ, FIXED_STEPS, LENGTH, MASS, ROD, last
from tests.solver.statics.resting import ZERO, N, ramp, static

SMALL = 1e-5 * EJ / LENGTH**2
"""A force (N) that bends the rod by so little that a beam's theory holds to nine digits."""
HINGE = FIXED, FREE, FIXED
SUPPORTS = {"start": End((FIXED,) * 3, HINGE, "lab"), "end": End((FIXED, FIXED, FREE), HINGE, "lab")}


@pytest.mark.parametrize("at", [0.5, 7 / N, 0.43, 0.985, 1 / 3])
def test_a_simply_supported_beam_has_the_moment_of_its_load_at_every_node(at: float) -> None:
    """With the load shared between the middles of two segments it was too small by up to a fourth of P h."""
    load = PointLoad(at * LENGTH, (ramp(SMALL), ZERO, ZERO))
    s = np.linspace(0.0, LENGTH, N + 1)
    a, b = at * LENGTH, (1.0 - at) * LENGTH
    theory = SMALL * np.where(s < a, b * s, a * (LENGTH - s)) / LENGTH
    moment = np.abs(last(static(points=(load,), **SUPPORTS)).q[:, 1])
    np.testing.assert_allclose(moment, theory, atol=1e-7 * theory.max())


@pytest.mark.parametrize("frame", ["lab", "material"])
@pytest.mark.parametrize("at", [0.2, 0.31, 0.9])
def test_a_free_rod_that_is_pushed_turns_as_a_rigid_body_at_first(frame: str, at: float) -> None:
    push, t_end = 1e-3, 1e-2
    stiff = replace(ROD, stiffness=tuple(Curve.constant(1e9 * EJ) for _ in range(3)))
    load = PointLoad(at * LENGTH, (Curve.constant(push), ZERO, ZERO), frame=frame)
    scene = Scene(stiff, Initial.straight(), End.free(), End.free(), t_end, t_end, points=(load,),
                  numerics=Numerics("staggered", intervals=7, dt_max=1.0, increment_tolerance=FIXED_STEPS))
    *_, frame_ = simulate(scene)
    inertia = MASS * LENGTH**3 / 12 * (1 + 0.75 * (DIAMETER / LENGTH) ** 2)
    assert frame_.omega[3, 1] == pytest.approx(push * (at - 0.5) * LENGTH * t_end / inertia, rel=2e-3)
    assert abs(frame_.energy_balance) <= 1e-6 * frame_.work_loads
