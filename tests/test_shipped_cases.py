"""Every shipped case through the real solver: what it must show."""

from __future__ import annotations

import json
from functools import cache
from math import asinh, atan, isnan, pi, sinh, sqrt
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq

from hockle.milestones import milestones
from service.cases import apply_settings, build_scene, load_case, parse_case, shipped_cases
from service.results import DatasetWriter, open_dataset
from solver import Frame, Scene, simulate
from solver.kernels.rotation import rotate

Array = NDArray[np.float64]

EI = 1.25e7 * pi * 0.01**4 / 64


@cache
def run(name: str, settings: str = "{}") -> tuple[Scene, list[Frame]]:
    """The scene of a shipped case and its frames; settings as JSON."""
    spec = parse_case(apply_settings(load_case(name), json.loads(settings)))
    scene = build_scene(spec)
    frames = list(simulate(scene))
    assert len(frames) == spec.frames
    return scene, frames


def energy(frame: Frame) -> float:
    return (
        frame.energy_bending
        + frame.energy_torsion
        + frame.energy_kinetic
        + frame.energy_added_mass
        + frame.energy_potential
        + frame.energy_contact
    )


def moving_cases() -> list[str]:
    return [name for name in shipped_cases() if "static" not in name]


@pytest.mark.parametrize("name", moving_cases())
def test_the_energy_balance_closes(name: str):
    _, frames = run(name)
    height = frames[0].energy_potential
    stored = [
        f.energy_bending + f.energy_torsion + f.energy_kinetic + abs(f.energy_potential - height)
        for f in frames
    ]
    assert max(abs(f.energy_balance) for f in frames) < 0.01 * max(stored)


@pytest.mark.parametrize("name", shipped_cases())
def test_the_rod_keeps_its_length_and_its_frames_stay_orthonormal(name: str):
    scene, frames = run(name)
    ds = scene.rod.length / scene.numerics.intervals
    for frame in frames[:: max(1, len(frames) // 10)]:
        assert np.linalg.norm(frame.orientation, axis=1) == pytest.approx(1.0, abs=1e-12)
        # A chord is shorter than its arc by (kappa ds)^2 / 24, and the mean of two unit tangents than 1 by
        # (kappa ds)^2 / 8; inextensibility itself holds to second order in dt.
        curvature = np.linalg.norm(frame.kappa[:, :2], axis=1).max()
        chords = np.linalg.norm(np.diff(frame.r, axis=0), axis=1)
        assert chords == pytest.approx(ds, rel=5e-4 + (curvature * ds) ** 2 / 8)


def test_the_papers_cable_meets_the_milestones(tmp_path: Path):
    spec = parse_case(load_case("goyal-2003"))
    scene, frames = run("goyal-2003")
    path = tmp_path / "cable.nc"
    simulation = simulate(scene)
    with DatasetWriter(path, spec) as writer:
        for frame in frames:
            writer.append(frame)
        writer.publish("completed", "", simulation)
    with open_dataset(path) as dataset:
        told = {name: value for name, value, _ in milestones(dataset)}
    # References of two converged implementations; the tolerances are those of the default settings.
    assert told["buckling (s)"] == pytest.approx(15.8843, abs=0.1)
    assert told["torsional energy maximum (s)"] == pytest.approx(17.756, abs=0.1)
    assert told["mid-span tangent perpendicular (s)"] == pytest.approx(25.7501, abs=0.1)
    assert told["Wr = 1 (s)"] == pytest.approx(28.2523, abs=0.1)
    assert told["first contact (s)"] == pytest.approx(28.65, abs=0.1)
    assert told["Wr at 32 s (turns)"] == pytest.approx(2.0728, abs=0.05)
    assert told["Lk at 32 s (turns)"] == pytest.approx(3.965408, abs=1e-4)


def test_the_papers_cable_never_passes_through_itself():
    _, frames = run("goyal-2003")
    defect = np.array([f.Tw + f.Wr - f.Lk for f in frames])
    assert np.abs(defect).max() < 0.01


def test_the_elastica_comes_to_rest_where_euler_says():
    _, frames = run("elastica")
    last = frames[-1]
    tip = last.r[-1]
    tangent = rotate(last.orientation[-1:], np.array([[0.0, 0.0, 1.0]]))[0]
    # Second order in ds = 0.01: with kappa of order 3 / L the error is some (kappa ds)^2 / 12 = 1e-4.
    assert tip[0] == pytest.approx(0.713792, abs=1e-4)
    assert 1.0 - tip[2] == pytest.approx(0.387628, abs=1e-4)
    assert np.arctan2(tangent[0], tangent[2]) == pytest.approx(1.215368, abs=2e-4)
    assert last.energy_kinetic < 1e-9 * last.energy_bending


def test_the_cantilever_vibrates_at_its_first_frequency():
    _, frames = run("cantilever-vibration")
    t = np.array([f.t for f in frames])
    tip = np.array([f.r[-1, 0] for f in frames])
    free = t > 2.0

    # Fit of the first mode alone; the push of two seconds leaves little in the higher ones.
    def misfit(rate: float) -> float:
        basis = np.column_stack([np.cos(rate * t[free]), np.sin(rate * t[free])])
        return float(np.linalg.lstsq(basis, tip[free], rcond=None)[1][0])

    rates = np.linspace(0.79, 0.815, 251)
    rate = rates[np.argmin([misfit(x) for x in rates])]
    assert rate == pytest.approx(0.802405, rel=1e-3)


def test_the_plucked_cantilever_keeps_its_energy():
    _, frames = run("cantilever-vibration")
    free = np.array([energy(f) for f in frames if f.t >= 2.5])
    assert np.ptp(free) < 2e-4 * free.mean()


def test_below_greenhills_torque_the_rod_stays_straight_under_it():
    _, frames = run("greenhill")
    last = frames[-1]
    assert last.q[:, 2] == pytest.approx(0.97 * 8.98682 * EI, rel=1e-4)
    # A push of 1e-4 N/m bends the untwisted rod by q L^4 / (384 EI) = 4e-5 m; 97 % of the torque makes the
    # rod softer by 1 / (1 - 0.97^2) = 17.
    assert np.abs(last.r[:, :2]).max() < 17 * 1e-4 / (384 * EI)
    assert last.energy_kinetic < 1e-5 * last.energy_bending


def test_above_greenhills_torque_it_buckles():
    twist = 1.03 * 8.98682 / 0.8
    _, frames = run("greenhill", json.dumps({"initial.twist.value": [0.0, twist], "t_end": 4.0}))
    bent = [np.abs(f.r[:, :2]).max() for f in frames]
    assert bent[-1] > 10 * bent[10]
    growth = np.diff(np.log(bent[20:]))
    assert growth == pytest.approx(growth.mean(), rel=0.2)  # exponential


def momenta(frame: Frame, scene: Scene) -> tuple[Array, Array]:
    """Linear momentum, and angular momentum about the origin, lab frame (trapezoidal in s)."""
    s = np.linspace(0.0, scene.rod.length, len(frame.r))
    velocity = rotate(frame.orientation, frame.v)
    inertia = np.column_stack([profile(s) for profile in scene.rod.inertia])
    spin = rotate(frame.orientation, inertia * frame.omega)
    momentum = scene.rod.mass(s)[:, None] * velocity
    return np.trapezoid(momentum, s, axis=0), np.trapezoid(np.cross(frame.r, momentum) + spin, s, axis=0)


def test_free_flight_keeps_momentum_and_energy():
    scene, frames = run("free-flight")
    first, last = frames[0], frames[-1]
    mass = float(scene.rod.mass(np.zeros(1))[0]) * scene.rod.length
    linear, angular = momenta(first, scene)
    # The box scheme too sums momentum by the trapezoidal rule: the linear one is kept to rounding, the
    # angular one to second order in dt, since a step's path is a chord: (5 rad/s dt)^2 / 12.
    assert linear == pytest.approx(mass * np.array([0.3, 0.0, 0.1]), rel=1e-9, abs=1e-12)
    later, turned = momenta(last, scene)
    assert later == pytest.approx(linear, rel=1e-9, abs=1e-12)
    assert turned == pytest.approx(angular, abs=3e-4 * float(np.linalg.norm(angular)))
    assert energy(last) == pytest.approx(energy(first), rel=1e-3)
    assert last.f[[0, -1]] == pytest.approx(0.0, abs=1e-9)
    assert last.q[[0, -1]] == pytest.approx(0.0, abs=1e-9)


def test_the_hanging_cable_settles_across_the_current():
    _, frames = run("hanging-cable")
    last = frames[-1]
    area = pi * 0.02**2 / 4
    weight = (2000 - 1025) * 9.81 * area
    drag = 0.5 * 1025 * 0.02 * 1.2 * 0.3**2
    middle = len(last.r) // 2
    lean = atan(last.r[middle, 1] / -last.r[middle, 2])
    # The cable's steeper parts lie a little along the current, which takes less drag there.
    assert atan(0.9 * drag / weight) < lean < atan(drag / weight)
    load = sqrt(weight**2 + drag**2)
    scale = brentq(lambda a: 2 * a * sinh(4 / a) - 10, 1.0, 20.0)
    assert last.f[middle, 2] == pytest.approx(load * scale, rel=0.05)
    assert asinh(5 / scale) * scale == pytest.approx(4.0)
    assert last.energy_kinetic < 1e-3 * max(f.energy_kinetic for f in frames)


def test_the_loop_is_held_apart_by_its_contact():
    scene, frames = run("short-loop")
    last = frames[-1]
    assert scene.contact is not None
    assert frames[0].contacts == 0
    assert frames[0].energy_contact == 0.0
    assert last.contacts > 0
    assert last.energy_contact > 0.0
    first = next(f.min_gap for f in frames if not isnan(f.min_gap))  # before, the total curvature rules contact out
    assert 0.0 < last.min_gap < first / 2
    assert max(abs(f.Tw + f.Wr - frames[0].Tw - frames[0].Wr) for f in frames) < 0.01


def test_the_static_elastica_is_eulers_at_every_load():
    _, frames = run("static-elastica")
    for alpha, deflection in ((1, 0.301721), (2, 0.493457), (5, 0.713792), (10, 0.810609)):
        frame = frames[alpha]
        assert frame.parameter == pytest.approx(alpha)
        # second order in ds = 0.01, as above
        assert frame.r[-1, 0] == pytest.approx(deflection, abs=1e-4)
        assert frame.negative_modes == 0
