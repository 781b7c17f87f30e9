"""Cases: the scene that they build."""

from __future__ import annotations

from math import pi, radians
from typing import Any

import numpy as np
import pytest

from service.cases import CaseError, apply_settings, build_scene, load_case, parse_case
from solver import simulate
from solver.scene.layout import nodes_at_rest
from solver.scene.scene import Scene


def scene(name: str, **settings: Any) -> Scene:
    return build_scene(parse_case(apply_settings(load_case(name), settings)))


def test_the_papers_cable_has_its_diameter_and_properties():
    built = scene("goyal-2003")
    s = np.linspace(0.0, 1.0, 1001)
    diameter = 4.95e-4 * (1 - 0.1 * np.exp(-(((s - 0.5) / 0.0863) ** 2)))
    # A cubic spline errs by 5/384 h^4 D'''': 0.1 * 12 / 0.0863^4 * 1e-8 * 5/384 = 3e-6 of D.
    assert built.rod.diameter(s) == pytest.approx(diameter, rel=1e-5)
    assert built.rod.mass(s) == pytest.approx(1500 * pi / 4 * diameter**2, rel=2e-5)
    assert built.rod.stiffness[0](s) == pytest.approx(1.25e7 * pi / 64 * diameter**4, rel=4e-5)
    assert built.rod.stiffness[2](s) == pytest.approx(5e6 * pi / 32 * diameter**4, rel=4e-5)
    assert built.distributed[0].force[0](s) == pytest.approx(1.061e-4 * built.rod.mass(s), rel=2e-5)


def test_the_papers_cable_is_turned_as_fitted():
    omega3 = scene("goyal-2003").start.rotation[2][0].curve
    r1, r2 = 2.8517 / 5.119, 0.04182

    def step(x: float) -> float:
        x = min(max(x, 0.0), 1.0)
        return x * x * (3 - 2 * x)

    for t in np.linspace(0.0, 7.0, 141):
        a, b = step(t / 0.5), step((t - 5.119) / 0.5)
        assert omega3.value(t) == pytest.approx(-2 * pi * (r1 * a * (1 - b) + r2 * b), rel=1e-10, abs=1e-12)


def test_the_papers_sliding_end_is_stopped_at_thirty_seconds():
    axial = scene("goyal-2003").end.translation[2]
    assert [(c.kind, c.since, c.within) for c in axial] == [("load", 0.0, 0.0), ("stop", 30.0, 0.1)]
    assert axial[0].curve.is_zero


def test_angles_are_given_in_degrees_and_built_in_radians():
    contact = scene("goyal-2003").contact
    assert contact is not None
    assert contact.aperture == pytest.approx(radians(70))


def test_a_component_takes_the_place_of_the_presets_own():
    ends = scene("short-loop").end
    assert [c[0].kind for c in ends.translation] == ["rate", "rate", "position"]
    assert ends.translation[2][0].curve.value(2.0) == pytest.approx(-0.05)
    assert ends.frame == "lab"


def test_an_end_may_be_written_out_without_a_preset():
    six = {"x1": 0.0, "v2": 0.5, "f3": 2.0, "omega1": 0.0, "theta2": 0.1, "q3": -1.0}
    end = scene("elastica", **{"ends.start": six}).start
    assert [c[0].kind for c in end.translation] == ["position", "rate", "load"]
    assert [c[0].kind for c in end.rotation] == ["rate", "position", "load"]
    assert end.rotation[2][0].curve.value(0.0) == -1.0


def test_a_switch_to_a_preset_changes_all_that_it_does_not_name():
    switches = [{"at": 2.0, "preset": "free", "q3": 0.5}, {"at": 3.0, "preset": "clamp"}]
    end = scene("elastica", **{"ends.end": {"preset": "pin", "switches": switches}, "loads.point": []}).end
    for component in (*end.translation, *end.rotation):
        first, free, held = component
        assert (free.kind, free.since, held.kind, held.since) == ("load", 2.0, "rate", 3.0)
        assert free.curve.value(2.5) == (0.5 if component is end.rotation[2] else 0.0)
        assert first.kind == ("rate" if component in end.translation else "load")


def test_properties_given_directly_take_the_place_of_moduli():
    raw = load_case("elastica")
    raw["rod"] = {
        "length": 1.0,
        "diameter": 0.01,
        "bending_stiffness": [1.0, 2.0],
        "torsional_stiffness": {"s": [0, 1], "value": [1.0, 3.0], "interpolation": "linear"},
        "mass_per_length": 0.1,
        "inertia_per_length": [1e-6, 2e-6, 3e-6],
        "kappa0": [0.0, 1.0, 0.0],
    }
    rod = build_scene(parse_case(raw)).rod
    s = np.array([0.0, 0.5, 1.0])
    assert [p(s).tolist() for p in rod.stiffness] == [[1, 1, 1], [2, 2, 2], [1, 2, 3]]
    assert rod.mass(s).tolist() == [0.1] * 3
    assert [p(s)[0] for p in rod.inertia] == [1e-6, 2e-6, 3e-6]
    assert rod.kappa0[1](s).tolist() == [1.0] * 3


def test_a_mass_per_length_is_enough():
    raw = load_case("elastica")
    del raw["rod"]["density"]
    raw["rod"]["mass_per_length"] = 1500.0 * pi / 4 * 1e-4
    rods = [build_scene(parse_case(case)).rod for case in (raw, load_case("elastica"))]
    s = np.array([0.5])
    assert rods[0].mass(s) == pytest.approx(rods[1].mass(s))
    for mine, solid in zip(rods[0].inertia, rods[1].inertia, strict=True):
        assert mine(s) == pytest.approx(solid(s))


def test_one_bending_stiffness_serves_both_axes():
    raw = load_case("elastica")
    del raw["rod"]["youngs_modulus"]
    raw["rod"]["bending_stiffness"] = 2.0
    rod = build_scene(parse_case(raw)).rod
    s = np.array([0.5])
    assert rod.stiffness[0](s) == rod.stiffness[1](s) == 2.0
    assert rod.stiffness[2](s) == pytest.approx(5e6 * pi / 32 * 1e-8)


def test_an_initial_shape_can_be_free_of_stress():
    built = scene("short-loop")
    s = np.linspace(0.0, built.rod.length, built.numerics.intervals + 1)
    _, _, kappa = nodes_at_rest(built.initial, s)
    stress_free = np.column_stack([profile(s) for profile in built.rod.kappa0])
    assert stress_free == pytest.approx(kappa, rel=1e-12, abs=1e-9)
    assert np.abs(kappa).max() > 10


def test_what_a_case_leaves_out_is_absent_in_the_scene():
    built = scene("free-flight")
    assert built.fluid is None
    assert built.contact is None
    assert built.distributed == ()
    assert built.points == ()
    assert built.gravity == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("turns", [1, 6])
@pytest.mark.parametrize("numerics", [
    {"method": "box", "intervals": 60, "dt_max": 0.02}, {"method": "staggered", "intervals": 60, "dt_max": 0.02},
    {"verify": True, "intervals": 60, "dt_max": 0.02}, {"tolerance": 1e-3},
])  # fmt: skip
def test_a_rod_whose_natural_shape_is_its_initial_one_stays_at_rest(numerics, turns):
    """Found among the stress test's random cases, [1, 330]: curvature sampled twice as finely was another one."""
    angle = np.linspace(0.0, 2 * pi * turns, 40 * turns + 1)
    raw = load_case("short-loop")
    raw["rod"]["length"] = float(np.hypot(0.05, 0.02) * angle[-1])
    raw["initial"] = {"shape": "centreline", "a1": [1.0, 0.0, 0.0], "points": np.column_stack(
        [0.05 * np.cos(angle), 0.05 * np.sin(angle), 0.02 * angle]).tolist()}  # fmt: skip
    raw |= {"ends": {"start": "free", "end": "pin"}, "loads": {}, "t_end": 0.1, "output": {"interval": 0.02}}
    raw["numerics"] = numerics
    del raw["contact"]
    built = build_scene(parse_case(raw))
    unit = float(built.rod.stiffness[0](np.zeros(1))[0]) / built.rod.length
    for frame in simulate(built):
        assert frame.energy_bending + frame.energy_torsion + frame.energy_kinetic < 1e-20 * unit


def test_contact_needs_no_constants():
    raw = load_case("short-loop")
    assert not build_scene(parse_case(raw)).contact.automatic
    for given in ({}, {"spacing": 1e-3}):
        built = build_scene(parse_case(raw | {"contact": given})).contact
        assert built.automatic
        assert built.spacing == given.get("spacing")


def test_a_force_that_cannot_follow_an_end_is_named():
    following = {"s": 1.0, "force": [1.0, 0.0, 0.0], "frame": "material"}
    settings = {"ends.end": {"preset": "free", "frame": "lab"}, "rod.length": 1.0, "loads.point": [following]}
    with pytest.raises(CaseError, match="free along lab axes must be") as refused:
        scene("cantilever-vibration", **settings)
    assert [fault.pointer for fault in refused.value.errors] == ["/loads/point/0"]
