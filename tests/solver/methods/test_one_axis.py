"""Scenes that turn about one axis: the same discrete solution as in space, and which scenes are taken for such."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

import solver.methods.one_axis
from solver import (
    FIXED,
    FREE,
    Condition,
    Contact,
    Curve,
    DistributedLoad,
    End,
    Fluid,
    Frame,
    Initial,
    Numerics,
    PointLoad,
    Scene,
    Statistics,
    simulate,
)
from solver.arrays import Array
from solver.kernels.rotation import matrix_of
from solver.methods.one_axis import OneAxisMethod
from solver.methods.space.one_axis.axis import axis_of
from solver.methods.space.one_axis.fields import InSpace
from solver.methods.staggered import StaggeredMethod
from solver.scene.curve import constant_vector
from tests.solver.scenes import ARC, ARC_ROD, EJ, GJ, LENGTH, ROD, arc, turned_clamp

SAME = 1e-8
"""Of the largest value of a field in a run: what two iterations to 1e-10 rad may differ by after many steps."""
NUMERICS = Numerics(method="staggered", intervals=24, dt_max=0.05)

ZERO = Curve.constant(0.0)
GROWTH = Curve.table([0.0, 0.3, 1.0], [0.0, 1.0, 1.0], "smoothstep")
SHIFT = Curve.table([0.0, 0.3, 1.0], [0.0, 0.2, 0.2], "smoothstep")
FORCE = EJ / LENGTH**2
WATER = Fluid(1000.0, 1.0, 1.2, 0.3, current=(0.1, 0.0, -0.05))
CANTILEVER = Scene(ROD, Initial.straight(), End.clamp(), End.free(), 0.6, 0.1, gravity=(1.0, 0.0, -9.81), fluid=WATER,
                   damping=0.3, numerics=NUMERICS)  # fmt: skip
SKEW = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [0.3, -1.0, 2.0], [1.0, 0.2, 1.0]]))[0]
"""A rotation that takes no axis of the lab to another one."""


def in_plane(first: Curve, third: Curve) -> tuple[Curve, Curve, Curve]:
    return (first, ZERO, third)


def across(moment: Curve) -> tuple[Curve, Curve, Curve]:
    return (ZERO, moment, ZERO)


def skew(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = SKEW @ np.array(vector)
    return float(x), float(y), float(z)


def tilted() -> Scene:
    """An arc with weight and current in a plane that is none of the lab's."""
    return replace(CANTILEVER, rod=ARC_ROD, initial=Initial(lambda s: arc(s) @ SKEW.T, a1=skew((1.0, 0.0, 0.0))),
                   gravity=skew((1.0, 0.0, -9.81)), fluid=replace(WATER, current=skew((0.1, 0.0, -0.05))))  # fmt: skip


def thrown() -> Scene:
    """An arc that flies and turns, under loads of every kind."""
    constant = Curve.constant
    along = DistributedLoad(in_plane(constant(FORCE), constant(0.5 * FORCE)), across(constant(0.1 * FORCE)),
                            schedule=GROWTH)  # fmt: skip
    points = (PointLoad(0.33, in_plane(GROWTH, ZERO), across(ZERO), "material"),
              PointLoad(0.41, in_plane(SHIFT, GROWTH), across(ZERO)),
              PointLoad(LENGTH, in_plane(ZERO, SHIFT), across(ZERO), "material"),
              PointLoad(0.0, in_plane(ZERO, SHIFT), across(ZERO)))  # fmt: skip
    start = replace(ARC, velocity=(0.1, 0.0, 0.2), angular_velocity=(0.0, 1.0, 0.0))
    return replace(CANTILEVER, rod=ARC_ROD, initial=start, start=End.free(), t_end=0.4, fluid=None, points=points,
                   distributed=(along, replace(along, frame="material")))  # fmt: skip


def driven() -> Scene:
    """Rates, positions and loads at both ends, in material and in lab components, that stop and change in kind."""
    load = Condition("load", Curve.table([0.0, 0.3, 1.0], [0.0, FORCE, FORCE], "smoothstep"))
    turned = (Condition("rate", SHIFT), Condition("stop", since=0.2, within=0.1), Condition("load", since=0.4))
    start = End(((Condition("rate", SHIFT),), FIXED, (load,)), (FIXED, turned, FIXED))
    end = End(((Condition("position", SHIFT),), FIXED, (load,)), (FREE, (load,), FREE), frame="lab")
    return replace(CANTILEVER, rod=ARC_ROD, initial=ARC, start=start, end=end)


def spun(rate: float = 2.0, **others: object) -> Scene:
    """A straight rod along e2 whose free-sliding end is turned about its tangent, twisted from the start."""
    spin = turned_clamp(Condition("rate", Curve.table([0.0, 0.3, 1.0], [0.0, rate, rate], "smoothstep")))
    initial = Initial.straight((3.0, 1.0, 0.0), (0.0, 1.0, 0.0), twist=Curve.table([0.0, LENGTH], [0.0, 0.5]))
    given = {"initial": initial, "gravity": (0.0, -1.0, 0.0), "fluid": replace(WATER, current=(0.0, 0.3, 0.0)),
             "end": replace(spin, translation=(FIXED, FIXED, FREE))}  # fmt: skip
    return replace(CANTILEVER, **(given | others))


def let_go() -> Scene:
    """A twisted straight rod that flies along itself, one end pulled along e2 and turned by a moment."""
    moment = (Condition("load", Curve.table([0.0, 0.3], [0.0, 0.2 * GJ / LENGTH], "smoothstep")),)
    end = End((FREE, (Condition("load", SHIFT),), FREE), (FREE, FREE, moment), frame="lab")
    initial = replace(spun().initial, velocity=(0.0, 0.1, 0.0), angular_velocity=(0.0, 3.0, 0.0))
    return spun(initial=initial, start=End.free(), end=end, t_end=0.3)


SCENES = {
    "a cantilever in a current": CANTILEVER,
    "with the first principal axis across the plane": replace(CANTILEVER, initial=Initial.straight(a1=(0.0, 1.0, 0.0))),
    "in another plane": tilted(),
    "in flight under loads of every kind": thrown(),
    "driven at both ends": driven(),
    "a straight rod that is twisted": spun(),
    "a twisted straight rod let go": let_go(),
}


def run(scene: Scene, monkeypatch: pytest.MonkeyPatch, in_space: bool = False) -> tuple[list[Frame], Statistics]:
    with monkeypatch.context() as patch:
        if in_space:
            patch.setattr(solver.methods.one_axis, "axis_of", lambda scene: None)
        simulation = simulate(scene)
    assert isinstance(simulation._method, StaggeredMethod if in_space else OneAxisMethod)  # type: ignore[attr-defined]
    return list(simulation), simulation.statistics


def largest(values: list[Array]) -> float:
    return max(float(np.abs(np.nan_to_num(value)).max()) for value in values)


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_the_solution_is_that_in_space(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    mine, cost = run(scene, monkeypatch)
    theirs, its_cost = run(scene, monkeypatch, in_space=True)
    assert (cost.steps, cost.failed_steps) == (its_cost.steps, its_cost.failed_steps)
    energy = largest([np.array([f.energy_bending, f.energy_torsion, f.energy_kinetic]) for f in theirs])
    works = dict.fromkeys(("work_ends", "work_loads", "dissipation", "astray"), energy)
    scales = {"Tw": 1.0, "Wr": 1.0, "Lk": 1.0, "v": 0.1, "omega": 0.1, "q": EJ / LENGTH, "f": FORCE,
              "max_curvature": 1.0 / LENGTH, **works}  # fmt: skip
    for field in fields(Frame):
        one, two = ([np.asarray(getattr(frame, field.name), float) for frame in frames] for frames in (mine, theirs))
        if field.name in ("newton_iterations", "negative_modes", "neutral_modes"):
            continue
        least = energy if field.name.startswith("energy") else scales.get(field.name, 0.0)
        scale = max(largest(two), least)
        apart = [a - b for a, b in zip(one, two, strict=True)]
        assert np.array_equal(np.isnan(one[-1]), np.isnan(two[-1])), field.name
        assert largest(apart) <= SAME * scale, field.name


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_energy_is_accounted_for(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """To the order of Radau's quadrature at these steps."""
    *_, last = run(scene, monkeypatch)[0]
    turnover = abs(last.work_ends) + abs(last.work_loads) + last.dissipation + last.energy_kinetic
    assert abs(last.energy_balance) <= 1e-2 * turnover


def test_what_flies_keeps_its_momentum_and_angular_momentum() -> None:
    start = replace(ARC, velocity=(0.1, 0.0, 0.2), angular_velocity=(0.0, 1.0, 0.0))
    scene = Scene(ARC_ROD, start, End.free(), End.free(), 0.5, 0.1,
                  numerics=replace(NUMERICS, increment_tolerance=1e-5))  # fmt: skip
    simulation = simulate(scene)
    method = simulation._method  # type: ignore[attr-defined]
    momenta = []
    for _ in simulation:
        (place, velocity, _), chain = method._centres, method.chain
        spin = (chain.inertia * method.state.omega[1:-1]).sum() + (chain.mass * (place.conj() * velocity).imag).sum()
        momenta.append((chain.h * (chain.mass * velocity).sum(), chain.h * spin))
    (P, H), *others = momenta
    assert max(abs(p - P) for p, _ in others) <= 1e-9 * abs(P)
    assert max(abs(h - H) for _, h in others) <= 5e-7 * abs(H)


OUT_OF_PLANE = (0.0, 1e-6, 0.0)
FIRST = (Condition("rate", Curve.constant(1e-6)),)
CURVED = (Curve.constant(1e-6), Curve.constant(1.0), ZERO)
TOUCHES = Contact(1e-7, 3.0, 1e-6, 1.0, 1.0, 0.1, 0.3, 0.05)
UNEQUAL = (Curve.constant(EJ), Curve.constant(2.0 * EJ), Curve.constant(GJ))


def moved_in_lab(first: float, third: float) -> End:
    along = ((Condition("rate", Curve.constant(first)),), FIXED, (Condition("rate", Curve.constant(third)),))
    return End(along, (FIXED, FIXED, FIXED), frame="lab")


REFUSED = {
    "contact": replace(CANTILEVER, contact=TOUCHES),
    "a centreline out of the plane": replace(CANTILEVER, initial=Initial(lambda s: arc(s) @ SKEW.T)),
    "no principal axis across the plane": replace(
        CANTILEVER, initial=Initial.straight(a1=(1.0, 0.1, 0.0)), rod=replace(ROD, stiffness=UNEQUAL)),
    "twist in a plane": replace(CANTILEVER, initial=spun().initial),
    "natural curvature out of the plane": replace(CANTILEVER, rod=replace(ROD, kappa0=CURVED)),
    "weight out of the plane": replace(CANTILEVER, gravity=(1.0, 1e-6, -9.81)),
    "a current out of the plane": replace(CANTILEVER, fluid=replace(WATER, current=OUT_OF_PLANE)),
    "velocity out of the plane": replace(CANTILEVER, initial=Initial.straight(velocity=OUT_OF_PLANE)),
    "angular velocity in the plane": replace(CANTILEVER, initial=Initial.straight(angular_velocity=(1.0, 0.0, 0.0))),
    "a distributed force out of the plane": replace(
        CANTILEVER, distributed=(DistributedLoad(constant_vector(OUT_OF_PLANE)),)),
    "a distributed moment in the plane": replace(
        CANTILEVER, distributed=(DistributedLoad(moment=constant_vector((1e-6, 0.0, 0.0)), frame="material"),)),
    "a point load that leaves the plane late": replace(
        CANTILEVER, points=(PointLoad(LENGTH, (ZERO, Curve.table([0.0, 9.0, 9.1], [0.0, 0.0, 1e-6]), ZERO)),)),
    "a point moment in the plane": replace(CANTILEVER, points=(PointLoad(0.5, moment=(GROWTH, ZERO, ZERO)),)),
    "an end that is moved out of the plane": replace(
        CANTILEVER, start=End((FIXED, FIRST, FIXED), (FIXED, FIXED, FIXED))),
    "an end that is turned out of the plane": replace(
        CANTILEVER, start=End((FIXED, FIXED, FIXED), (FIXED, FIXED, FIRST))),
    "an end that is moved out of the plane later": replace(
        CANTILEVER, start=End((FIXED, (*FIXED, replace(FIRST[0], since=0.5)), FIXED), (FIXED, FIXED, FIXED))),
    "an end with lab components in a plane that is none of the lab's": replace(tilted(), start=moved_in_lab(0.0, 0.0)),
    "a force across a twisted rod": spun(gravity=(1e-6, -1.0, 0.0)),
}  # fmt: skip


@pytest.mark.parametrize("scene", REFUSED.values(), ids=REFUSED)
def test_what_may_leave_the_plane_is_solved_in_space(scene: Scene) -> None:
    assert axis_of(scene) is None


@pytest.mark.parametrize(
    ("scene", "index"),
    [
        (CANTILEVER, 1),
        (replace(CANTILEVER, start=moved_in_lab(1.0, 0.5)), 1),
        (replace(CANTILEVER, initial=Initial.straight(a1=(0.0, 1.0, 0.0))), 0),
        (tilted(), 1),
        (spun(), 2),
        (let_go(), 2),
    ],
)
def test_the_axis_is_found(scene: Scene, index: int) -> None:
    axis = axis_of(scene)
    assert axis is not None
    assert axis.index == index
    R, lying = np.zeros((3, 3)), InSpace.of(axis, np.zeros(3))
    matrix_of(np.cos(0.15) * lying.begin + np.sin(0.15) * lying.half, R)
    assert np.abs(R[:, index] - axis.n).max() <= 1e-15
    T = np.exp(0.3j * axis.swing)
    assert np.abs(axis.in_lab(T * axis.material)[[2]] - R[:, 2]).max() <= 1e-15
