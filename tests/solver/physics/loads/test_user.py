"""A user's own load: the same motion and the same books as the load of the solver's own that it copies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import End, Fluid, Frame, Initial, Numerics, Scene, UserLoad, simulate
from solver.arrays import Array
from solver.scene.ends import FIXED, FREE
from tests.solver.scenes import ARC, ROD

METHODS = ["box", "staggered"]
G = np.array([0.3, -1.0, 2.0])
DIAMETER = float(ROD.diameter(np.zeros(1))[0])
WEIGHT = float(ROD.mass(np.zeros(1))[0]) * G
DRAG = 0.5 * 1000.0 * DIAMETER * 1.2


class Weight(UserLoad):
    """m g."""

    account = "stored"

    def force(self, t: float, s: Array, r: Array, V: Array) -> Array:
        return np.tile(WEIGHT, (len(s), 1))

    def energy(self, t: float, s: Array, r: Array) -> Array:
        return np.asarray(-r @ WEIGHT)


class Push(Weight):
    """The same force, of which nobody knows where it comes from."""

    account = "given"


class Bed(UserLoad):
    """An elastic bed below the plane r . e3 = 0."""

    account = "stored"
    stiffness = 200.0

    def force(self, t: float, s: Array, r: Array, V: Array) -> Array:
        return np.outer(self.stiffness * np.maximum(-r[:, 2], 0.0), [0.0, 0.0, 1.0])

    def energy(self, t: float, s: Array, r: Array) -> Array:
        return np.asarray(0.5 * self.stiffness * np.maximum(-r[:, 2], 0.0) ** 2)


class Broken(UserLoad):
    """A load with a fault."""

    def force(self, t: float, s: Array, r: Array, V: Array) -> Array:
        if t > 0.05:
            raise RuntimeError("no such depth")
        return np.zeros((len(s), 3))


class Tide(Bed):
    """A bed whose energy rises though nothing moves."""

    def energy(self, t: float, s: Array, r: Array) -> Array:
        return super().energy(t, s, r) + 0.1 * t


def scene(method: str, **loads: object) -> Scene:
    """A curled rod, clamped at its start."""
    numerics = Numerics(method=method, intervals=20, dt_max=0.01)  # type: ignore[arg-type]
    return Scene(ROD, ARC, End.clamp(), End.free(), 0.2, 0.1, numerics=numerics, **loads)  # type: ignore[arg-type]


def last(scene: Scene) -> Frame:
    *_, frame = simulate(scene)
    return frame


@pytest.mark.parametrize("method", METHODS)
def test_a_users_weight_is_weight(method: str) -> None:
    mine, own = last(scene(method, loads=(Weight(),))), last(scene(method, gravity=tuple(G)))
    for name in ("r", "v", "f", "kappa"):
        assert_allclose(getattr(mine, name), getattr(own, name), atol=1e-7 * np.abs(getattr(own, name)).max())
    for name in ("energy_potential", "energy_kinetic", "work_loads", "energy_balance"):
        assert getattr(mine, name) == pytest.approx(getattr(own, name), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_the_power_of_a_load_that_is_given_is_its_work(method: str) -> None:
    pushed, weighed = last(scene(method, loads=(Push(),))), last(scene(method, gravity=tuple(G)))
    start = next(iter(simulate(scene(method, gravity=tuple(G)))))
    assert pushed.energy_potential == 0.0
    fallen = start.energy_potential - weighed.energy_potential
    assert pushed.work_loads == pytest.approx(fallen, rel=1e-4)
    assert pushed.energy_balance == pytest.approx(weighed.energy_balance, abs=1e-4 * abs(fallen))


@pytest.mark.parametrize("method", METHODS)
def test_a_users_drag_is_morisons(method: str) -> None:
    class Drag(UserLoad):
        """Of a straight rod along e3, which moves across."""

        account = "lost"

        def force(self, t: float, s: Array, r: Array, V: Array) -> Array:
            return -DRAG * np.linalg.norm(V[:, :2], axis=1)[:, None] * V * np.array([1.0, 1.0, 0.0])

    numerics = Numerics(method=method, intervals=20, dt_max=0.005)  # type: ignore[arg-type]
    thrown = Scene(ROD, Initial.straight(velocity=(0.5, 0.2, 0.0)), End.free(), End.free(), 0.1, 0.1, numerics=numerics)
    mine, own = last(replace(thrown, loads=(Drag(),))), last(replace(thrown, fluid=Fluid(1000.0, drag_normal=1.2)))
    assert_allclose(mine.v, own.v, atol=1e-8)
    assert mine.dissipation == pytest.approx(own.dissipation, rel=1e-8)
    assert own.dissipation > 0.1 * own.energy_kinetic


@pytest.mark.parametrize("method", METHODS)
def test_a_rod_that_falls_onto_an_elastic_bed_keeps_its_energy(method: str) -> None:
    lying = Initial.straight((0.0, 0.0, 0.05), (1.0, 0.0, 0.0), a1=(0.0, 1.0, 0.0), velocity=(0.0, 0.0, -0.5))
    numerics = Numerics(method=method, intervals=20, dt_max=0.002, rho_inf=1.0)  # type: ignore[arg-type]
    frames = list(simulate(Scene(ROD, lying, End.free(), End.free(), 0.4, 0.02, loads=(Bed(),), numerics=numerics)))
    pressed = max(frame.energy_potential for frame in frames)
    thrown = frames[0].energy_kinetic
    assert pressed > 0.9 * thrown  # for a moment it rests on the bed
    assert frames[-1].r[:, 2].mean() > 0.05  # and it is thrown back
    assert max(abs(frame.energy_balance) for frame in frames) < 2e-3 * thrown


@pytest.mark.parametrize("method", METHODS)
def test_what_a_users_load_raises_reaches_the_user(method: str) -> None:
    with pytest.raises(RuntimeError, match="no such depth"):
        last(scene(method, loads=(Broken(),)))


@pytest.mark.parametrize("method", METHODS)
def test_a_stored_energy_that_changes_by_itself_is_refused(method: str) -> None:
    with pytest.raises(ValueError, match="must not change with time"):
        last(scene(method, loads=(Tide(),)))


@pytest.mark.parametrize("method", METHODS)
def test_a_load_of_which_no_law_is_known_is_refused(method: str) -> None:
    with pytest.raises(TypeError, match="must be of a kind"):
        last(scene(method, loads=("a push",)))


def test_a_rod_in_statics_rests_on_its_bed() -> None:
    lying = Initial.straight((0.0, 0.0, -0.01), (1.0, 0.0, 0.0), a1=(0.0, 1.0, 0.0))
    numerics = Numerics(method="staggered", intervals=20)
    start = End((FIXED, FIXED, FREE), (FREE, FREE, FREE), "lab")  # on rails
    end = End((FREE, FIXED, FREE), (FREE, FREE, FREE), "lab")
    resting = Scene(ROD, lying, start, end, 1.0, 1.0, gravity=(0.0, 0.0, -9.81), loads=(Bed(),),
                    numerics=numerics, analysis="static")  # fmt: skip
    frame = last(resting)
    assert frame.negative_modes == 0
    assert_allclose(frame.r[:, 2], -9.81 * float(ROD.mass(np.zeros(1))[0]) / Bed.stiffness, rtol=1e-6)
