"""Laws of the bend: bending that softens when layers slip, and bending that locks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from service.cases import CaseError, apply_settings, build_scene, load_case, parse_case
from solver import FREE, Condition, Curve, End, Initial, Numerics, Rod, Scene, simulate
from solver.arrays import Array
from solver.methods.registry import discretized
from solver.physics.elasticity import Locking, Softening, add_strain, elasticity_of, moments, principal
from tests.solver.methods import problem as box
from tests.solver.methods.test_box_tangents import LARGEST_ERROR, error
from tests.solver.methods.test_staggered_tangents import check_rotation
from tests.solver.methods.test_staggered_tangents import problem as staggered_problem
from tests.solver.scenes import EJ, GJ, LENGTH, ROD, last

METHODS = ["box", "staggered"]
MORE, AT = 3.0 * EJ, 0.5 / LENGTH
BEND = 2.0 / LENGTH
Function = Callable[[Array], Array]
SOFTENING = Softening(Curve.constant(MORE), Curve.constant(AT))
LOCKING = Locking(Curve.constant(MORE), Curve.constant(AT))
LAWS: dict[str, tuple[object, Function, Function]] = {
    "softening": (SOFTENING, lambda b: MORE * b / np.sqrt(1.0 + (b / AT) ** 2),
                  lambda b: MORE * AT**2 * (np.sqrt(1.0 + (b / AT) ** 2) - 1.0)),
    "locking": (LOCKING, lambda b: MORE * np.where(b > AT, b - AT, 0.0),
                lambda b: 0.5 * MORE * np.where(b > AT, b - AT, 0.0) ** 2),
}  # fmt: skip
"""Each with the moment and the energy per length that it adds at a bend."""
each_law = pytest.mark.parametrize("name", LAWS)


def rod(name: str) -> Rod:
    return replace(ROD, laws=(LAWS[name][0],))


def moment(name: str, bend: Array) -> Array:
    """About the axis of the bend."""
    return np.asarray(EJ * bend + LAWS[name][1](bend))


def energy(name: str, bend: float) -> float:
    """Of the whole rod."""
    return float(0.5 * EJ * bend**2 + LAWS[name][2](np.array(bend))) * LENGTH


def bent(name: str, axis: int = 0, rise: float = 8.0) -> Scene:
    """A straight cantilever, bent to a part of a circle by a moment at its end; `axis`: a1 or a2."""
    load = Condition("load", Curve.table([0.0, rise], [0.0, float(moment(name, np.array(BEND)))], "smoothstep"))
    end = End((FREE, FREE, FREE), ((load,), FREE, FREE) if axis == 0 else (FREE, (load,), FREE))
    return Scene(rod(name), Initial.straight(), End.clamp(), end, 30.0, 30.0, damping=1.0)


@each_law
def test_the_moment_is_that_of_the_law(name: str) -> None:
    bend = np.array([0.0, 0.01, 0.3, 2.0, 40.0]) / LENGTH
    elastic = elasticity_of(rod(name), np.linspace(0.0, LENGTH, 5))
    q = moments(elastic, np.stack([0.6 * bend, -0.8 * bend, np.ones(5)], axis=1))
    assert_allclose(0.6 * q[:, 0] - 0.8 * q[:, 1], moment(name, bend))
    assert_allclose(q[:, 2], GJ)
    unstrained = EJ + (MORE if name == "softening" else 0.0)
    assert_allclose(principal(elastic)[0], [unstrained, unstrained, GJ])


@each_law
def test_strains_are_those_of_the_moments(name: str) -> None:
    elastic, kappa = elasticity_of(rod(name), np.zeros(1)), np.array([[1.0, -2.0, 3.0]])
    off = kappa + 1e-4
    q = (moments(elastic, kappa) - moments(elastic, off))[0]
    add_strain(elastic, 0, (*map(float, q),), off[0])
    assert_allclose(off, kappa, rtol=1e-7)


@pytest.mark.parametrize("analysis", ["static", "dynamic"])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("axis", [0, 1])
@each_law
def test_a_moment_bends_a_cantilever_to_a_circle(name: str, axis: int, method: str, analysis: str) -> None:
    numerics = Numerics(method=method, intervals=20, dt_max=0.05)  # type: ignore[arg-type]
    frame = last(replace(bent(name, axis), numerics=numerics, analysis=analysis))  # type: ignore[type-var]
    assert_allclose(np.abs(frame.kappa[:, axis]), BEND, rtol=2e-3)
    assert_allclose(np.abs(frame.q[:, axis]), moment(name, np.array(BEND)), rtol=2e-3)
    assert frame.energy_bending == pytest.approx(energy(name, BEND), rel=2e-3)


def imbalance(name: str, method: str, intervals: int) -> float:
    """The largest energy out of balance, over the largest that is stored, of a rod that is bent in half a period."""
    numerics = Numerics(method=method, intervals=intervals, dt_max=0.002, rho_inf=1.0)  # type: ignore[arg-type]
    scene = replace(bent(name, rise=1.0), t_end=1.0, output_interval=0.1, damping=0.0, numerics=numerics)
    frames = list(simulate(scene))
    stored = max(frame.energy_bending for frame in frames)
    assert max(frame.energy_kinetic for frame in frames) > 0.01 * stored
    return max(abs(frame.energy_balance) for frame in frames) / stored


@each_law
def test_the_work_on_the_rod_is_its_energy(name: str) -> None:
    assert imbalance(name, "staggered", 20) < 1e-4


def test_the_box_method_balances_it_to_the_square_of_an_interval() -> None:
    """Its moment is the mean of two nodes': that of their mean strain only where the law is linear."""
    coarse, fine = imbalance("softening", "box", 20), imbalance("softening", "box", 40)
    assert fine < 2e-4
    assert coarse / fine == pytest.approx(4.0, rel=0.3)


def bends_as_it_bends(plain: Rod) -> Rod:
    """A rod with both laws, with curvatures as it has them in a problem of tangents."""
    EJ = plain.stiffness[0]
    return replace(plain, laws=(Softening(EJ, Curve.constant(3.0)), Locking(EJ, Curve.constant(2.0))))


def test_the_box_method_has_the_tangents(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = box.rod
    monkeypatch.setattr(box, "rod", lambda diameter: bends_as_it_bends(plain(diameter)))
    assert error(box.problem(12)) <= LARGEST_ERROR


def test_the_staggered_method_has_the_tangents() -> None:
    check_rotation(staggered_problem("all of them", "free", rod=bends_as_it_bends(ROD)))


@each_law
def test_in_a_plane_it_turns_about_one_axis_and_does_the_same(name: str) -> None:
    numerics = Numerics(method="staggered", intervals=20, dt_max=0.01)
    scene = replace(bent(name, rise=1.0), t_end=1.0, output_interval=1.0, numerics=numerics)
    assert type(discretized(scene)).__name__ == "OneAxisMethod"
    out_of_it = replace(scene, gravity=(1e-9, 0.0, 0.0))
    assert type(discretized(out_of_it)).__name__ == "StaggeredMethod"
    plane, space = last(scene), last(out_of_it)
    assert_allclose(plane.r, space.r, atol=1e-6 * LENGTH)
    assert_allclose(plane.q, space.q, atol=1e-5 * float(moment(name, np.array(BEND))))
    assert plane.energy_bending == pytest.approx(space.energy_bending, rel=1e-5)


@pytest.mark.parametrize(("kind", "names"), [(Softening, ("sticking_stiffness", "slip_curvature")),
                                             (Locking, ("locking_stiffness", "locking_curvature"))])  # fmt: skip
def test_a_case_has_both_numbers_or_neither(kind: type, names: tuple[str, str]) -> None:
    both = dict.fromkeys([f"rod.{name}" for name in names], 2.0)
    (law,) = build_scene(parse_case(apply_settings(load_case("free-flight"), both))).rod.laws
    assert isinstance(law, kind)
    for one, other in (names, names[::-1]):
        with pytest.raises(CaseError, match=f"/rod/{other} must be given beside {one}"):
            parse_case(apply_settings(load_case("free-flight"), {f"rod.{one}": 2.0}))
