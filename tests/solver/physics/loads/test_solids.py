"""Floors, bars and balls with friction: what rests on them, what slides on them, and their tangents."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from service.cases import CaseError, apply_settings, build_scene, load_case, parse_case
from solver import End, Fluid, Frame, Initial, Numerics, Rod, Scene, simulate
from solver.arrays import Array
from solver.kernels.kernel import kernel
from solver.physics.loads import solids
from solver.physics.loads.load import Point, conservative, energy, force, tangents
from solver.physics.loads.solids import Floor, Obstacle
from solver.run.first_mesh import first_mesh
from solver.run.trial import intervals_of
from solver.run.verify import VerifiedFrame
from tests.solver.methods.problem import problem
from tests.solver.methods.test_box_tangents import LARGEST_ERROR, error
from tests.solver.scenes import ROD

METHODS = ["box", "staggered"]
G, MU, STIFFNESS = 9.81, 0.3, 2000.0
MASS = float(ROD.mass(np.zeros(1))[0])
BAR = Obstacle((-0.1, 0.0, 0.0), (0.3, 0.1, 0.0), 0.2, STIFFNESS, MU, slip=0.2)
FLOOR = Floor(STIFFNESS, 0.1, (0.6, 0.0, 0.8), MU, slip=0.2)
BALL = Obstacle((0.1, 0.05, 0.3), (0.1, 0.05, 0.3), 0.25, 0.4 * STIFFNESS, 0.5 * MU, slip=0.3)


def record(*given: solids.Given) -> solids.Record:
    scene = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 1.0, 1.0, loads=given)
    return solids.of(scene, None).record  # type: ignore[arg-type, no-any-return]


@kernel
def act(load: solids.Record, at: Point):  # type: ignore[no-untyped-def]
    return force(load, 0, 0, at)[0], tangents(load, 0, 0, at), energy(load, 0, 0, at), conservative(load, 0, 0, at)


def at(r: Array, V: Array) -> Point:
    zero, R = (0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    return Point(tuple(map(float, r)), tuple(map(float, V)), zero, (0.0, 0.0, 1.0), R, zero)


PLACES = {"beside the bar": (0.12, 0.0, -0.1), "beyond its end": (-0.17, 0.03, -0.06),
          "in bar and ball": (0.1, 0.0, 0.15), "below the floor": (-0.4, 0.1, -0.3),
          "outside": (0.3, 1.0, 0.0)}  # fmt: skip


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
def test_their_tangents_are_their_derivatives(place: tuple[float, float, float]) -> None:
    load, r, V = record(BAR, BALL, FLOOR), np.array(place), np.array([0.3, -0.5, 0.4])
    acting, by, _, pushed = act(load, at(r, V))
    still = act(load, at(r, 0.0 * V))[1].C
    for k, e in enumerate(1e-6 * np.eye(3)):
        K = np.subtract(act(load, at(r + e, V))[0], act(load, at(r - e, V))[0]) / 2e-6
        C = np.subtract(act(load, at(r, e))[0], act(load, at(r, -e))[0]) / 2e-6
        assert_allclose(np.array(by.K)[:, k], K, atol=1e-5)
        assert_allclose(np.array(still)[:, k], C, atol=1e-5)
        fall = (act(load, at(r - e, V))[2] - act(load, at(r + e, V))[2]) / 2e-6
        assert pushed[k] == pytest.approx(fall, abs=1e-5)
    assert_allclose(np.array(by.C) @ V, np.subtract(acting, pushed), atol=1e-12)  # a secant to where it sticks


def test_a_bar_pushes_away_from_its_axis_and_a_ball_from_its_middle() -> None:
    pushed = act(record(BAR), at(np.array([0.1, 0.05, 0.15]), np.zeros(3)))[0]
    assert_allclose(pushed, [0.0, 0.0, STIFFNESS * 0.05], atol=1e-9)
    pushed = act(record(BALL), at(np.array([0.1, 0.05, 0.1]), np.zeros(3)))[0]
    assert_allclose(pushed, [0.0, 0.0, -0.4 * STIFFNESS * 0.05], atol=1e-9)
    assert_allclose(act(record(BALL), at(np.array(BALL.start), np.zeros(3)))[0], 0.0)  # no side is the nearest there


def test_the_box_method_has_their_tangents() -> None:
    """Where friction is a resistance to motion, which its tangent is a secant of where it slides."""
    given = (Floor(40.0, 0.01, (0.1, 0.2, 1.0), friction=8e3, slip=1e4),
             Obstacle((0.0, 0.0, -0.1), (0.0, 0.0, 1.1), 0.3, 40.0, friction=8e3, slip=1e4),
             Obstacle((0.1, 0.0, 0.5), (0.1, 0.0, 0.5), 0.4, 30.0))  # fmt: skip
    assert error(problem(12, others=given)) <= LARGEST_ERROR  # type: ignore[arg-type]


def lying(height: float, **motion: tuple[float, float, float]) -> Initial:
    return Initial.straight((0.0, 0.0, height), (1.0, 0.0, 0.0), a1=(0.0, 1.0, 0.0), **motion)


def frames(method: str, initial: Initial, given: solids.Given, t_end: float, dt: float,
           damping: float = 0.0) -> list[Frame]:  # fmt: skip
    numerics = Numerics(method=method, intervals=10, dt_max=dt, rho_inf=0.9)  # type: ignore[arg-type]
    return list(simulate(Scene(ROD, initial, End.free(), End.free(), t_end, t_end / 10, gravity=(0.0, 0.0, -G),
                               loads=(given,), numerics=numerics, damping=damping)))  # fmt: skip


ON = {"floor": Floor(STIFFNESS), "bar": Obstacle((-1.0, 0.0, -0.5), (2.0, 0.0, -0.5), 0.5, STIFFNESS)}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("solid", ON.values(), ids=ON)
def test_a_rod_comes_to_rest_where_a_solid_bears_its_weight(solid: solids.Given, method: str) -> None:
    last = frames(method, lying(0.0), solid, 2.0, 0.02, damping=8.0)[-1]
    assert_allclose(last.r[:, 2], -MASS * G / STIFFNESS, rtol=1e-3)
    assert_allclose(last.r[:, 1], 0.0, atol=1e-9)


def test_a_rod_lies_in_the_valley_between_two_floors() -> None:
    slopes = tuple(Floor(STIFFNESS, normal=(0.0, side, 1.0)) for side in (-1.0, 1.0))
    numerics = Numerics(method="staggered", intervals=10, dt_max=0.02)
    *_, last = simulate(Scene(ROD, lying(0.0), End.free(), End.free(), 2.0, 2.0, gravity=(0.0, 0.0, -G), loads=slopes,
                              damping=8.0, numerics=numerics))  # fmt: skip
    # each bears k d with d = depth / sqrt 2, of which 1 / sqrt 2 is upwards
    assert_allclose(last.r[:, 2], -MASS * G / STIFFNESS, rtol=1e-3)
    assert_allclose(last.r[:, 1], 0.0, atol=1e-9)


SLOW = 1e-3
UNDER = {"floor": Floor(STIFFNESS, friction=MU, slip=SLOW),
         "bar": Obstacle((-1.0, 0.0, -5.0), (3.0, 0.0, -5.0), 5.0, STIFFNESS, MU, SLOW)}  # fmt: skip


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("solid", "way"), [("floor", 1), ("bar", 0)])
def test_a_rod_that_slides_is_stopped_by_friction_which_takes_its_energy(solid: str, way: int, method: str) -> None:
    """Across itself on a floor, along itself on a bar."""
    sunk, speed = -MASS * G / STIFFNESS, 0.5
    thrown = lying(sunk, velocity=(0.0, speed, 0.0) if way else (speed, 0.0, 0.0))
    early, *_, last = frames(method, thrown, UNDER[solid], 0.4, 0.002)
    assert early.energy_kinetic == pytest.approx(0.5 * MASS * speed**2, rel=1e-3)
    assert np.abs(last.v).max() < 2.0 * SLOW
    # it slides v^2 / (2 mu g), but for the slip at its end
    assert (last.r[:, way].mean() if way else last.r[0, 0]) == pytest.approx(speed**2 / (2.0 * MU * G), rel=0.02)
    assert last.dissipation == pytest.approx(early.energy_kinetic, rel=5e-3)
    assert abs(last.energy_balance) < 5e-3 * early.energy_kinetic


def test_both_methods_lay_a_rod_over_a_bar_across_it() -> None:
    across = Obstacle((0.5, -1.0, -0.1), (0.5, 1.0, -0.1), 0.1, 20 * STIFFNESS, MU)
    ends = []
    for method in METHODS:
        numerics = Numerics(method=method, intervals=80, dt_max=0.005)  # type: ignore[arg-type]
        scene = Scene(ROD, lying(0.0), End.free(), End.free(), 4.0, 4.0, gravity=(0.0, 0.0, -G), loads=(across,),
                      numerics=numerics, damping=10.0)  # fmt: skip
        last = list(simulate(scene))[-1]
        assert last.r[40, 2] == pytest.approx(0.0, abs=2e-3)  # it lies on the bar
        assert_allclose(last.r[0] * [-1.0, 1.0, 1.0] + [1.0, 0.0, 0.0], last.r[-1], atol=1e-6)  # as in a mirror
        ends.append(last.r[-1, 2])
    assert ends[0] < -0.4
    assert ends[0] == pytest.approx(ends[1], rel=2e-4)


@pytest.mark.parametrize("method", METHODS)
def test_a_rod_thrown_at_a_bar_comes_back_however_long_the_steps(method: str) -> None:
    """A step may be twenty times as long as it takes to fly through the bar."""
    speed, radius = 20.0, 0.05
    bar = Obstacle((-1.0, 0.0, -0.52), (2.0, 0.0, -0.52), radius, 4.0 * MASS * (speed / radius) ** 2)
    numerics = Numerics(method=method, intervals=10, dt_max=0.1)  # type: ignore[arg-type]
    thrown = lying(0.0, velocity=(0.0, 0.0, -speed))
    *_, last = simulate(Scene(ROD, thrown, End.free(), End.free(), 0.2, 0.2, loads=(bar,), numerics=numerics))
    assert last.r[:, 2].min() > 0.0


def bouncing(t: Array, height: float, k: float) -> Array:
    """How high (m) a bar of `MASS` is above a floor at times t that it falls on flat from a height, and leaves again:
    free fall, and the swing of a mass on a spring."""
    w, v = np.sqrt(k / MASS), np.sqrt(2.0 * G * height)
    touching = 2.0 * (np.pi - np.arctan2(v / w, G / w**2)) / w
    since = (t - v / G) % (2.0 * v / G + touching)
    on, up = since - touching < 0.0, since - touching
    swing = G / w**2 * (np.cos(w * since) - 1.0) - v / w * np.sin(w * since)
    return np.where(t < v / G, height - 0.5 * G * t**2, np.where(on, swing, v * up - 0.5 * G * up**2))


def test_a_bar_that_falls_flat_bounces_as_high_again_however_long_the_steps() -> None:
    """Steps that leapt over the blows of 6 ms took the energy; now one ends where the bar meets or leaves the floor."""
    height, k = 0.3, 1e5
    numerics = Numerics("staggered", intervals=4, dt_max=0.1, increment_tolerance=0.016, strides=5)
    scene = Scene(ROD, lying(height), End.free(), End.free(), 1.5, 0.05, gravity=(0.0, 0.0, -G), loads=(Floor(k),),
                  numerics=numerics)  # fmt: skip
    shown = list(simulate(scene))
    above, t = np.array([frame.r[0, 2] for frame in shown]), np.array([frame.t for frame in shown])
    assert_allclose(above, bouncing(t, height, k), atol=3e-3)


def test_a_rod_that_rises_in_water_bounces_below_a_lid() -> None:
    """To a tolerance: a step of five frames met the lid, and the next left it with an energy from nowhere."""
    D, water, k, lid = 0.02, 1000.0, 2e4, 2.0
    rod, area = Rod.circular(0.8, D, 1e9, 4e8, 600.0), 0.25 * np.pi * D**2
    scene = Scene(rod, lying(0.5), End.free(), End.free(), 6.0, 0.1, gravity=(0.0, 0.0, -G),
                  fluid=Fluid(water, 1.0, 1.0), loads=(Floor(k, -lid, (0.0, 0.0, -1.0)),),
                  numerics=Numerics("staggered", tolerance=1e-3))  # fmt: skip

    def rate(_: float, y: Array) -> tuple[float, float]:
        force = (water - 600.0) * area * G - 0.5 * water * D * abs(y[1]) * y[1] - k * max(y[0] - lid, 0.0)
        return y[1], force / ((600.0 + water) * area)

    frames = list(simulate(scene))
    true = solve_ivp(rate, (0.0, 6.0), (0.5, 0.0), t_eval=[frame.t for frame in frames], rtol=1e-9, atol=1e-11,
                     max_step=2e-3)  # fmt: skip
    for frame, z in zip(frames, true.y[0], strict=True):
        assert isinstance(frame, VerifiedFrame)
        assert_allclose(frame.r[:, 2], z, atol=3.0 * float(frame.error.r.max()) + 1e-7)
        assert float(frame.error.r.max()) < 1e-3 * 0.8


def test_a_case_has_a_floor_and_obstacles() -> None:
    bar = {"start": [0, 0, -1], "end": [1, 0, -1], "radius": 0.1, "stiffness": 50.0, "friction": 0.1}
    ball = {"start": [0, 0, -1], "radius": 0.1, "stiffness": 50.0}
    floor = {"stiffness": 10.0, "height": -0.2, "friction": 0.1}
    raw = apply_settings(load_case("free-flight"), {"loads.obstacles": [bar, ball], "loads.floor": floor})
    assert build_scene(parse_case(raw)).loads == (
        Floor(10.0, -0.2, (0.0, 0.0, 1.0), 0.1, 1e-3), Obstacle((0.0, 0.0, -1.0), (1.0, 0.0, -1.0), 0.1, 50.0, 0.1),
        Obstacle((0.0, 0.0, -1.0), (0.0, 0.0, -1.0), 0.1, 50.0))  # fmt: skip


def test_an_obstacle_without_a_size_is_refused() -> None:
    flat = {"start": [0, 0, 0], "radius": 0, "stiffness": 1}
    raw = apply_settings(load_case("free-flight"), {"loads.obstacles": [flat]})
    with pytest.raises(CaseError, match="/loads/obstacles/0/radius"):
        parse_case(raw)
    with pytest.raises(ValueError, match="obstacle radius must be > 0, got 0"):
        Obstacle((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 1.0)


def test_to_a_tolerance_the_first_mesh_is_no_coarser_than_an_obstacle() -> None:
    ball = Obstacle((0.5, 0.0, -0.5), (0.5, 0.0, -0.5), 0.012, STIFFNESS)
    scene = Scene(ROD, lying(0.0), End.free(), End.free(), 1.0, 1.0, gravity=(0.0, 0.0, -G), loads=(ball,))
    assert intervals_of(first_mesh(scene, pressed=False)) == 128


def test_depth_is_that_of_a_place_below_the_surface() -> None:
    places = np.array([[0.0, 0.0, 0.0], [-0.6, 0.0, 0.0]])
    assert_allclose(FLOOR.depth(places), [0.1, 0.46], atol=1e-12)
    assert_allclose(BAR.depth(places), [0.2 - 0.1 * np.sin(np.arctan(0.25)), 0.2 - 0.5], atol=1e-12)
    assert_allclose(BALL.depth(np.array([[0.1, 0.05, 0.4]])), [0.15], atol=1e-12)


@pytest.mark.parametrize("axis", [(0.0, 1.0, 0.0), (1.0, 0.0, 0.0)], ids=["across the slope", "along the slope"])
def test_a_rod_that_slides_without_turning_is_followed_into_its_slide(axis: tuple[float, float, float]) -> None:
    """v' = g (sin a - mu cos a v / sqrt(v^2 + v0^2)): Newton's iteration has nothing but the rod's place to see."""
    slope, friction, slip = np.radians(27.0), 0.31, 0.005
    normal = (float(np.sin(slope)), 0.0, float(np.cos(slope)))
    down = np.array([np.cos(slope), 0.0, -np.sin(slope)])
    along = axis if axis[1] else tuple(map(float, down))
    rod = Rod.circular(0.4, 0.01, 7e10, 2.6e10, 2700.0)
    depth = float(rod.mass(np.zeros(1))[0]) * 9.81 * np.cos(slope) / 2e5
    start = tuple(float(-depth * x) for x in normal)
    floor, numerics = Floor(2e5, 0.0, normal, friction, slip), Numerics(method="staggered", tolerance=1e-3)
    scene = Scene(rod, Initial.straight(start, along), End.free(), End.free(), 2.0, 0.5, gravity=(0.0, 0.0, -9.81),
                  loads=(floor,), numerics=numerics)  # fmt: skip
    frames = list(simulate(scene))

    def rates(_t: float, y: Array) -> list[float]:
        return [y[1], 9.81 * (np.sin(slope) - friction * np.cos(slope) * y[1] / np.hypot(y[1], slip))]

    exact = solve_ivp(rates, (0.0, 2.0), [0.0, 0.0], method="Radau", rtol=1e-10, atol=1e-12,
                      t_eval=[frame.t for frame in frames]).y[0]  # fmt: skip
    travelled = [(frame.r[0] - frames[0].r[0]) @ down for frame in frames]
    assert_allclose(travelled, exact, atol=1e-3 * rod.length)


def test_a_chain_that_is_hauled_to_and_fro_over_a_rough_floor_takes_few_iterations() -> None:
    """It took 95,900, as many as its steps were short: see decision 0036."""
    t, stiffness = np.linspace(0.0, 8.0, 65), 4e4
    sway, heave = 0.3 * np.sin(np.pi * t) * (1.0 - np.exp(-t)), 0.3 * (1.0 - np.cos(np.pi * t))
    moved = [{"t": t.tolist(), "value": x.tolist(), "interpolation": "cubic"} for x in (sway, heave)]
    chain = {"length": 20.0, "diameter": 0.05, "bending_stiffness": 1.0, "torsional_stiffness": 1.0,
             "mass_per_length": 10.0, "axial_stiffness": 1e7}  # fmt: skip
    run = simulate(build_scene(parse_case({
        "schema_version": 1, "rod": chain,
        "initial": {"shape": "straight", "direction": [1, 0, 0], "origin": [0, 0, -10.0 * G / stiffness]},
        "ends": {"start": "free", "end": {"preset": "pin", "frame": "lab", "x1": moved[0], "x3": moved[1]}},
        "loads": {"gravity": [0, 0, -G], "damping": 0.5, "floor": {"stiffness": stiffness, "friction": 0.6}},
        "t_end": 8.0, "output": {"interval": 0.2},
        "numerics": {"method": "staggered", "intervals": 16, "dt_max": 0.2},
    })))  # fmt: skip
    *_, last = run
    assert run.statistics.newton_iterations < 30_000
    assert np.abs(last.energy_balance) < 0.01 * last.dissipation
