"""What a case would cost is told by the documented model, and what is too much is refused."""

from __future__ import annotations

import json
from math import cos, pi, sin
from pathlib import Path

import pytest

from service.cases import CaseError, apply_settings, build_scene, check_cost, estimate, load_case, outlook, parse_case
from service.cases.cost import ELSEWHERE, STEP, STEP_NODE, WRITHE

MEASURED = json.loads((Path(__file__).parents[2] / "benchmarks" / "results" / "last.json").read_text())


def cost(**settings):
    told = {key.replace("__", "."): value for key, value in settings.items()}
    return estimate(parse_case(apply_settings(load_case("cantilever-vibration"), told)))


def test_steps_frames_and_bytes_are_those_of_the_case():
    told = cost(t_end=10.0, numerics__dt_max=0.05, numerics__intervals=100, output__interval=0.5)
    assert (told.nodes, told.frames, told.steps) == (101, 21, 200)
    assert told.bytes == 8 * 21 * 101 * 23
    only_r = cost(t_end=10.0, numerics__intervals=100, output__interval=0.5, output__fields=["r"])
    assert only_r.bytes == 8 * 21 * 101 * 3


def test_there_are_no_fewer_steps_than_frames():
    assert cost(t_end=10.0, numerics__dt_max=1.0, output__interval=0.1).steps == 100


def test_twice_the_time_costs_twice():
    assert cost(t_end=20.0).seconds == pytest.approx(2 * cost(t_end=10.0).seconds, rel=0.01)


def test_topology_costs_with_the_square_of_the_nodes():
    with_, without = (cost(numerics__intervals=10_000, output__topology=told) for told in (True, False))
    assert with_.seconds - without.seconds == pytest.approx(with_.frames * WRITHE * 10_001**2)


@pytest.mark.parametrize("row", MEASURED["scene_s"], ids=lambda row: f"{row['intervals']:.0f}")
def test_the_rates_are_those_that_were_measured_within_a_factor_of_four(row):
    a_step = row["CPU stepping"] / row["steps"]
    assert a_step / 4 < STEP + STEP_NODE * (row["intervals"] + 1) < 4 * a_step


def test_a_case_beyond_the_bound_is_refused_with_what_it_asks_for():
    spec = parse_case(apply_settings(load_case("cantilever-vibration"), {"t_end": 1000.0}))
    seconds = estimate(spec).seconds
    check_cost(spec, 1.01 * seconds)
    with pytest.raises(CaseError) as refused:
        check_cost(spec, 0.99 * seconds)
    [fault] = refused.value.errors
    assert (fault.pointer, fault.value) == ("/t_end", 1000.0)
    assert "steps" in fault.rule


def test_a_static_analysis_costs_by_its_frames():
    told = parse_case(apply_settings(load_case("static-elastica"), {"numerics.dt_max": 1e-3}))
    assert estimate(told).steps == 11 + 15
    assert estimate(told).seconds < 1.0


def test_a_static_analysis_to_a_tolerance_costs_by_its_frames_and_by_what_makes_it_dear():
    def seconds(**more):
        settings = {"numerics.tolerance": 1e-3} | {key.replace("__", "."): value for key, value in more.items()}
        return estimate(parse_case(apply_settings(load_case("static-elastica"), settings))).seconds

    alone = seconds()
    assert alone == pytest.approx(ELSEWHERE * outlook.STATIC * (10 + outlook.STATIC_START))
    start = outlook.STATIC_START
    assert seconds(output__interval=0.1) == pytest.approx(alone * (100 + start) / (10 + start))
    assert seconds(loads__floor={"stiffness": 1.0}) == pytest.approx(alone * outlook.DEARER["on solids"])
    assert seconds(contact={}) == pytest.approx(alone * outlook.DEARER["touching"])
    assert seconds(rod__kappa0=[0, 5.0, 0]) == pytest.approx(alone * outlook.DEARER["stressed at the start"])
    assert seconds(numerics__tolerance=1e-5) == pytest.approx(alone * 100.0**0.25)


def told_of(case, **settings):
    return estimate(parse_case(apply_settings(load_case(case), {k.replace("__", "."): v for k, v in settings.items()})))


@pytest.mark.parametrize(("method", "usual", "given", "times"), [
    ("box", 0.1, 1e-5, 100.0), ("box", 0.1, 1.0, 1.0), ("staggered", 0.01, 1e-6, 10.0), ("box", 0.1, 1e-30, 2.0**22),
])  # fmt: skip
def test_a_smaller_increment_tolerance_makes_more_steps(method, usual, given, times):
    at = {"numerics__method": method, "t_end": 1.0, "output__interval": 0.1}
    before = cost(**at, numerics__increment_tolerance=usual).steps
    assert cost(**at, numerics__increment_tolerance=given).steps == pytest.approx(times * before, rel=1e-6)


def test_a_smaller_tolerance_costs_more_up_to_what_is_spent_on_one():
    at = [told_of("cantilever-vibration", numerics__tolerance=one).seconds for one in (1e-2, 1e-3, 1e-4, 1e-6)]
    assert at[0] == at[1] < at[2] < at[3] < 15.0
    verified = told_of("cantilever-vibration", numerics__tolerance=1e-6, numerics__verify=True)
    assert verified.seconds == at[3]  # a tolerance has its errors already


def moved(preset="clamp", to=20.0, **conditions):
    """An end that is moved, by names of conditions that go to the same value, or by some through many."""
    values = {name: value if isinstance(value, list) else [0, to] for name, value in conditions.items()}
    return {"preset": preset} | {name: {"t": list(range(len(value))), "value": value, "interpolation": "linear"}
                                 for name, value in values.items()}  # fmt: skip


SEA, AIR = {"fluid__density": 1000.0}, {"fluid__density": 1.2}
def arc(angle):
    """A circular arc of 1 m, as long as the case's rod, that turns by an angle (rad)."""
    at, R = [angle * i / 200 for i in range(201)], 1.0 / angle
    points = [[R * (1 - cos(a)), 0.0, R * sin(a)] for a in at]
    return {"shape": "centreline", "points": points, "a1": [0.0, 1.0, 0.0]}


def pushed(force):
    """A force in the middle of an arc of 1 rad, in EJ/L^2, that grows."""
    load = {"t": [0.0, 1.0], "value": [0.0, force * STIFFNESS], "interpolation": "smoothstep"}
    return [{"s": 0.5, "force": [load, 0, 0]}]


STIFFNESS = 1.25e7 * pi * 0.01**4 / 64
RING = arc(6.1)
TWISTED = {"shape": "straight", "direction": [0, 0, 1],
           "twist": {"s": [0, 1], "value": [0, 6.0], "interpolation": "linear"}}  # fmt: skip
PINNED = {"ends__start": "pin", "ends__end": "pin", "initial": arc(1.0), "rod__kappa0": "initial",
          "loads__damping": 1.0}  # fmt: skip
STRUCK = [{"s": 0.5, "force": [{"t": [0.0, 0.1, 0.2], "value": [0.0, 8.0 * STIFFNESS, 0.0],
                                "interpolation": "linear"}, 0, 0]}]  # fmt: skip
TAUT = {"loads__point": [{"s": 1.0, "force": [0, 0, 200.0 * STIFFNESS]}]}
LYING, ASKEW = [9.81, 0, 0], [9.81, 9.81, 0]


@pytest.mark.parametrize(("settings", "kind"), [
    ({}, "undamped"),
    ({"loads__damping": 1.0}, "followed by the frames"),
    ({"loads__gravity": LYING}, "let go or loaded at once"),
    ({"loads__gravity": [1e-3, 0, 0], "loads__damping": 1.0}, "let go gently"),
    ({"loads__gravity": [1e-3, 0, 0], "loads__point": []}, "swinging as a stick"),
    ({"loads__point": [], "ends__start": moved(x1=True, to=1.0)}, "moved and ringing"),
    ({"loads__gravity": [1e7, 1e7, 0]}, "limp and moved"),
    ({"loads__gravity": LYING, "loads__damping": 1e3}, "overdamped"),
    ({"loads__gravity": ASKEW}, "in space and moved or let go"),
    ({"loads__gravity": ASKEW, "loads__damping": 0.1}, "swinging in space"),
    ({"loads__gravity": [1e-3, 1e-3, 0], "loads__damping": 0.1}, "slow in space"),
    ({"loads__gravity": [1e-3, 1e-3, 0]}, "slow in space"),
    ({"loads__gravity": [0.1, 0.1, 0], "loads__damping": 3.0}, "settling in space"),
    ({"loads__gravity": [1e3, 1e3, 0], "loads__damping": 30.0}, "limp in space"),
    ({"loads__point": STRUCK}, "struck"),
    (SEA | {"loads__point": STRUCK}, "struck in water"),
    ({"loads__point": []}, "still"),
    ({"loads__gravity": ASKEW, "loads__damping": 0.1, "ends__start": moved(x1=True, to=1.0)},
     "in space and moved or let go"),
    ({"loads__gravity": ASKEW, "loads__damping": 0.1, "loads__point": [{"s": 1.0, "force": [0.1 * STIFFNESS, 0, 0]}]},
     "in space and moved or let go"),
    ({"ends__end": "clamp"}, "held straight"),
    ({"ends__end": moved(x3=True, to=-1e-4)}, "held straight and moved"),
    ({"ends__end": moved(x3=True, to=-0.1)}, "held straight and springing"),
    ({"ends__end": moved(x3=True, to=-1e-4), "rod__kappa0": [5.0, 0, 0]}, "held straight and springing"),
    ({"ends__end": moved(x3=True, to=-0.1) | moved(theta3=True, to=5.0)}, "held straight and twisted"),
    ({"ends__start": "free", "loads__point": [], "loads__gravity": ASKEW}, "flying freely"),
    ({"ends__start": "free", "loads__point": [], "initial__angular_velocity": [0, 5, 0]}, "flying freely"),
    ({"ends__end": moved(x3=True, to=0.01)}, "taut and light"),
    ({"ends__end": "clamp", "loads__gravity": LYING}, "taut and heavy"),
    ({"ends__end": "clamp", "loads__gravity": LYING, "loads__damping": 1e3}, "overdamped"),
    ({"loads__floor": {"stiffness": 1.0}}, "on a floor"),
    ({"loads__floor": {"stiffness": 1.0, "normal": [1, 0, 0]}, "ends__start": "free", "loads__point": []},
     "slides as a whole"),
    ({"loads__obstacles": [{"start": [0, 0, -9], "radius": 1.0, "stiffness": 1.0}]}, "on a floor"),
    ({"ends__end": moved(theta3=True)}, "wound up"),
    ({"ends__end": moved(theta3=True), "loads__damping": 1e3}, "overdamped and wound up"),
    ({"ends__end": moved("slider", theta3=True) | {"f3": 5.0 * STIFFNESS}}, "wound up"),
    ({"ends__end": moved("slider", theta3=True) | {"f3": 100.0 * STIFFNESS}, "loads__damping": 5.0},
     "settling in space"),  # pulled taut
    ({"loads__gravity": LYING, "loads__damping": 3.0}, "let go and settling"),
    (PINNED | {"ends__end": "clamp", "loads__gravity": LYING, "loads__damping": 3.0},
     "let go and settling between holds"),
    ({"contact": {}, "initial": RING}, "lies on itself"),
    ({"contact": {}, "initial": arc(2.0)}, "may spring onto itself"),
    ({"contact": {}, "initial": arc(2.0), "rod__kappa0": "initial", "ends__start": "free",
      "loads__point": [{"s": 1.0, "force": [0.1 * STIFFNESS, 0, 0]}]}, "may spring onto itself"),
    ({"contact": {}, "initial": RING, "rod__kappa0": "initial", "loads__point": []}, "still"),
    (PINNED | {"loads__gravity": LYING}, "let go between pins"),
    (PINNED | {"loads__point": pushed(15.0)}, "followed by the frames"),
    (PINNED | {"loads__point": pushed(17.0)}, "snapping through"),
    ({"ends__start": moved("pin", theta3=True), "ends__end": "free"}, "spun"),
    (SEA, "in water"),
    (SEA | {"ends__start": moved(x1=True)}, "towed through water"),
    (SEA | {"ends__start": moved(x1=[0.0, 1.0, 0.0, 1.0])}, "shaken in water"),
    (SEA | {"loads__gravity": [0, 0, 1e7]}, "long and heavy in water"),
    (SEA | {"loads__gravity": ASKEW}, "in space and in water"),
    (SEA | {"loads__gravity": ASKEW, "ends__start": moved(x1=True)}, "in space and in water"),
    (SEA | {"initial": arc(1.0)}, "let go in water"),
    ({"ends__end": "slider", "loads__gravity": LYING}, "loaded on a slide"),
    ({"rod__axial_stiffness": 10.0, "ends__end": {"preset": "pin", "frame": "lab", "switches": [
        {"at": 1.0, "f1": 0.0, "f2": 0.0, "f3": 0.0}]}}, "let go and stretching"),
    ({"rod__kappa0": "initial", "initial": arc(12.0), "ends__start": moved(x1=True, x2=True, to=1.0),
      "loads__point": [], "loads__damping": 0.1}, "a coil that is moved"),
    ({"loads__gravity": ASKEW, "loads__damping": 8.0, "ends__start": moved(x1=True, to=1.0)},
     "moved and settling in space"),
    (AIR | {"ends__start": moved(x1=[0.0, 1.0, 0.0, 1.0])}, "shaken in air"),
    (SEA | TAUT | {"ends__start": moved(x1=[0.0, 1.0, 0.0, 1.0])}, "shaken under tension"),
    (SEA | TAUT | {"loads__gravity": ASKEW, "ends__start": moved(x1=[0.0, 1.0, 0.0, 1.0])}, "shaken under tension"),
    ({"ends__start": moved(theta3=True, to=0.3), "loads__point": []}, "twisted to and fro"),
    ({"ends__end": moved(x3=True, to=-0.1), "loads__damping": 1e5}, "overdamped"),
    ({"loads__point": STRUCK, "loads__damping": 2.0}, "followed by the frames"),
    ({"loads__point": STRUCK, "loads__damping": 2.0,
      "ends__end": moved("pin") | {"frame": "lab", "f3": 5e3 * STIFFNESS}}, "struck"),  # as a string is faster
    ({"initial": TWISTED, "ends__end": "free", "loads__damping": 1.0}, "in space and moved or let go"),
    ({"initial": TWISTED, "ends__end": "slider", "loads__damping": 1.0}, "settling in space"),
])  # fmt: skip
def test_what_moves_the_rod_tells_what_a_tolerance_is_likely_to_cost(settings, kind):
    told = {"output.interval": 4.0} | {key.replace("__", "."): value for key, value in settings.items()}
    case = parse_case(apply_settings(load_case("cantilever-vibration"), {"numerics.tolerance": 1e-3} | told))
    assert outlook.kind_of(build_scene(case)) == kind
    assert estimate(case).seconds >= outlook.likely_seconds(build_scene(case)) >= outlook.SECONDS[kind]


def test_a_piece_that_stands_for_a_body_costs_what_finding_its_end_does():
    def seconds(heavy):
        mass = {"s": [0.0, 0.95, 0.96, 1.0], "value": [1.0, 1.0, heavy, heavy], "interpolation": "linear"}
        rod = {"rod.mass_per_length": mass, "rod.density": None, "rod.inertia_per_length": [1e-4] * 3}
        driven = {"ends.start": moved(x1=True, to=1e-3), "loads.point": [], "loads.damping": 1.0,
                  "t_end": 6.0, "output.interval": 0.1}  # fmt: skip
        return outlook.likely_seconds(build_scene(parse_case(apply_settings(load_case("cantilever-vibration"),
                                                                            rod | driven))))  # fmt: skip

    assert seconds(100.0) == outlook.SECONDS["with a heavy piece"] > seconds(10.0)


def test_a_schedule_with_many_points_makes_as_many_steps():
    times = [i * 1e-3 for i in range(9000)]
    load = {"s": 0.5, "force": [{"t": times, "value": [0.0] * 9000, "interpolation": "linear"}, 0, 0]}
    assert cost(t_end=8.0, output__interval=1.0, loads__point=[load]).steps == 7999


def test_contact_points_and_pairs_cost():
    at = [told_of("goyal-2003", contact__spacing=spacing).seconds for spacing in (1e-3, 1e-4, 5e-5)]
    assert at[0] < at[1] < at[2]


@pytest.mark.parametrize(("spacing", "what"), [(1e-7, "contact points"), (1e-5, "pairs of contact points")])
def test_contact_that_would_not_fit_into_memory_is_refused_by_its_field(spacing, what):
    with pytest.raises(CaseError) as refused:
        told_of("goyal-2003", contact__spacing=spacing)
    [fault] = refused.value.errors
    assert (fault.pointer, fault.value) == ("/contact/spacing", spacing)
    assert what in fault.rule and "must leave at most" in fault.rule


def test_contact_whose_spacing_follows_from_a_thin_rod_is_bounded_too():
    case = load_case("goyal-2003") | {"contact": {}}
    case["rod"] = case["rod"] | {"diameter": 1e-6}
    with pytest.raises(CaseError, match=r"0\.4 diameters"):
        parse_case(case)


def test_tables_that_would_not_fit_into_memory_are_refused_by_the_longest():
    many = 10_000
    table = {"s": [i / many for i in range(many)], "value": [0.0] * many, "interpolation": "linear"}
    loads = [{"force": [table] * 3} for _ in range(7)]
    case = load_case("cantilever-vibration")
    parse_case(apply_settings(case, {"loads.distributed": loads[:6]}))
    with pytest.raises(CaseError) as refused:
        parse_case(apply_settings(case, {"loads.distributed": loads}))
    [fault] = refused.value.errors
    assert fault.pointer == "/loads/distributed/0/force/0"
    assert "200,000 points" in fault.rule and "210," in fault.rule


def test_an_equilibrium_costs_the_same_whatever_dt_max_it_is_told():
    told = [parse_case(apply_settings(load_case("static-elastica"), {"numerics.dt_max": dt})) for dt in (5e-324, 0.1)]
    assert estimate(told[0]) == estimate(told[1])


def test_a_rod_that_a_load_at_its_end_moves_later_is_not_still():
    """Two masts were bent, and let go, by what their ends bore: they took 4 s, and .1 s were foreseen."""
    def kind(end):
        loaded = apply_settings(load_case("cantilever-vibration"), {"loads.point": [], "ends.end": end})
        return outlook.kind_of(build_scene(parse_case(loaded)))

    pull = {"t": [0.0, 1.0], "value": [0.0, 0.01], "interpolation": "smoothstep"}
    assert kind({"preset": "free"}) == "still"
    assert kind({"preset": "free", "frame": "lab", "f1": pull}) != "still"
    let_go = {"preset": "free", "frame": "lab", "f1": pull, "switches": [{"at": 1.5, "preset": "free"}]}
    assert kind(let_go) == "struck"


def test_what_rings_undamped_costs_by_the_frame():
    ringing = apply_settings(load_case("cantilever-vibration"), {"numerics": {"tolerance": 1e-3}, "loads.damping": 0.0})
    spec = parse_case(ringing)
    many = parse_case(apply_settings(ringing, {"output.interval": spec.t_end / 600}))
    few = parse_case(apply_settings(ringing, {"output.interval": spec.t_end / 60}))
    assert outlook.kind_of(build_scene(few)) == "undamped"
    ratio = outlook.likely_seconds(build_scene(many)) / outlook.likely_seconds(build_scene(few))
    assert ratio == pytest.approx(10.0)
