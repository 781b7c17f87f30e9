"""A rod that is held so that it has to stretch has the axial stiffness of its bar; no other has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solver import Condition, Curve, End, Initial, Numerics, Outcome, Rod, RunFailed, Scene, simulate
from solver.physics.axial import axial_compliance, axial_stiffness
from solver.scene.ends import FIXED, FREE
from validation.euler import AIM, BROUGHT, EA, LENGTH, elastica
from validation.euler import scene as buckled

ROD = Rod.circular(LENGTH, 0.01, 2e9, 2e9 / 2.6, 1150.0)
NUMERICS = Numerics(method="staggered", intervals=12, dt_max=0.02)
ACROSS = Initial.straight(direction=(1.0, 0.0, 0.0))


def moved(to: float, frame: str = "material") -> End:
    """A clamp that is moved along e3, or its a3, within a second."""
    condition = Condition("position", Curve.table([0.0, 1.0], [0.0, to], "smoothstep"))
    return End((FIXED, FIXED, (condition,)), (FIXED, FIXED, FIXED), frame)  # type: ignore[arg-type]


def held(end: End, initial: Initial | None = None, **more: object) -> Scene:
    scene = Scene(rod=ROD, initial=initial or Initial.straight(), start=End.clamp(), end=end, t_end=2.0,
                  output_interval=0.5, damping=40.0, numerics=NUMERICS)  # fmt: skip
    return replace(scene, **more)


def bent(length: float = 0.9) -> Initial:
    """An arc with a chord of so many rod lengths, about."""
    angle = np.sqrt(24.0 * (1.0 - length))
    return Initial(lambda s: np.stack([(1.0 - np.cos(angle * s)) / angle, 0.0 * s, np.sin(angle * s) / angle], axis=1),
                   a1=(0.0, 1.0, 0.0))  # fmt: skip


@pytest.mark.parametrize(
    ("scene", "stretches"),
    [
        (held(End.clamp()), True),
        (held(End.pin()), True),
        (held(moved(-0.1)), True),
        (held(End.slider()), False),
        (held(End.free()), False),
        (held(End.clamp(), bent()), False),
        (held(moved(0.2, "lab"), bent()), True),
        (held(moved(0.02, "lab"), bent()), False),
        (held(End((FIXED, FIXED, FREE), (FREE, FREE, FREE))), False),
    ],
)
def test_only_a_rod_that_is_held_as_far_apart_as_it_is_long_has_to_stretch(scene: Scene, stretches: bool) -> None:
    assert (axial_compliance(scene) > 0.0) is stretches


def test_the_stiffness_is_that_of_the_bar() -> None:
    assert axial_stiffness(held(End.clamp())) == pytest.approx(EA)
    assert axial_compliance(held(End.clamp())) == pytest.approx(LENGTH / EA)


@pytest.mark.parametrize("initial", [Initial.straight(), ACROSS, Initial.straight(direction=(1.0, -2.0, 0.5))])
@pytest.mark.parametrize("analysis", ["dynamic", "static"])
def test_a_bar_that_is_pulled_bears_its_strain(initial: Initial, analysis: str) -> None:
    run = simulate(held(moved(2e-3), initial, analysis=analysis))
    *_, last = run
    assert last.f[:, 2] == pytest.approx(2e-3 * EA / LENGTH, rel=1e-4)
    assert run.attributes()["axial_stiffness"] == pytest.approx(EA)
    assert run.attributes()["end_stretch"] == pytest.approx(2e-3, rel=1e-4)
    assert "axial stiffness EA" in run.notes()[-1] and "up to 0.002 m away" in run.notes()[-1]


def test_a_straight_rod_between_clamps_stays_as_it_is() -> None:
    *_, last = simulate(held(End.clamp()))
    assert np.abs(last.r - np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, LENGTH], 13)).max() < 1e-12


@pytest.mark.parametrize("analysis", ["dynamic", "static"])
def test_a_rod_between_clamps_that_come_together_buckles_as_the_elastica(analysis: str) -> None:
    numerics = replace(NUMERICS, intervals=20, dt_max=0.1, verify=True)
    *_, last = simulate(replace(buckled(0.1), analysis=analysis, numerics=numerics))
    across = abs(last.r[10, 0])
    assert across == pytest.approx(elastica(BROUGHT[-1] * LENGTH)[0], abs=AIM * LENGTH)


def test_ends_that_pull_it_by_more_than_a_tenth_are_told_as_that() -> None:
    with pytest.raises(RunFailed, match=r"nearer to each other than 1\.1 times") as failure:
        list(simulate(held(moved(0.3))))
    assert failure.value.outcome is Outcome.ROD_STRETCHED


def test_a_slack_rod_that_is_pulled_taut_stretches() -> None:
    run = simulate(held(moved(0.16, "lab"), bent()))
    *_, last = run
    assert last.f[:, 2].min() > 0.0
    assert run.attributes()["axial_stiffness"] == pytest.approx(EA)


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.6, 0.0, -0.8)])
def test_a_straight_rod_between_clamps_bears_what_loads_it_along_from_the_start(direction: tuple[float, ...]) -> None:
    """Half at either end, as its bar does: else it would bounce on it, and steps would follow that."""
    gravity = tuple(9.81 * component for component in direction)
    scene = held(End.clamp(), Initial.straight(direction=direction), gravity=gravity, damping=0.0)
    run = simulate(scene)
    frames = list(run)
    weight = 9.81 * float(ROD.mass(np.zeros(1))[0]) * LENGTH
    for frame in frames:
        assert frame.f[:, 2] == pytest.approx(weight * (0.5 - run.s / LENGTH), abs=1e-9 * weight)
        assert np.abs(frame.v).max() <= 1e-12
    assert run.statistics.steps < 300
