"""Energy that came from nowhere ends a run by name; an attempt at a tolerance is judged by it at its end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from service.cases import build_scene, load_case, parse_case
from solver import Outcome, RunFailed, Scene
from solver.run.simulation import Simulation


def hooked_wire() -> Scene:
    """A stiff wire with a bent tip that begins to turn slowly, by steps too long for how it rings at first."""
    angle = np.linspace(0.0, 0.5 * np.pi, 25)[1:, None]
    tip = 0.005 * np.hstack([1.0 - np.cos(angle), 0.1 * (1.0 - np.cos(angle)), 10.0 + np.sin(angle)])
    points = np.vstack([np.outer(np.linspace(0.0, 0.05, 40), [0.0, 0.0, 1.0]), tip])
    rate = {"t": [0.0, 1.0], "value": [0.0, 4.0 * np.pi], "interpolation": "smoothstep"}
    case = {
        "schema_version": load_case("free-flight")["schema_version"], "t_end": 0.5, "output": {"interval": 0.05},
        "rod": {"length": 0.0578746, "diameter": 4e-4, "youngs_modulus": 6e10, "shear_modulus": 2.3e10, "density": 6450,
                "kappa0": "initial"},
        "initial": {"shape": "centreline", "points": points.tolist()},
        "ends": {"start": {"preset": "clamp", "omega3": rate}, "end": "free"},
        "numerics": {"method": "staggered", "intervals": 64, "dt_max": 0.05, "increment_tolerance": 0.0158},
    }  # fmt: skip
    scene = build_scene(parse_case(case))
    return replace(scene, numerics=replace(scene.numerics, small_motion=1e-3))


def test_of_next_to_nothing_a_fifth_ends_a_run_but_no_attempt() -> None:
    """A tolerance was given up on every mesh, at the same early frame."""
    with pytest.raises(RunFailed) as failure:
        list(Simulation(hooked_wire()))
    assert failure.value.outcome is Outcome.ENERGY_MADE and failure.value.t < 0.5
    assert len(list(Simulation(hooked_wire(), goes_on=True))) == 11


def test_an_attempt_ends_by_it_too_if_it_is_much_at_the_end() -> None:
    with pytest.raises(RunFailed) as failure:
        list(Simulation(replace(hooked_wire(), t_end=0.3), goes_on=True))
    assert failure.value.outcome is Outcome.ENERGY_MADE and failure.value.t == pytest.approx(0.3)
