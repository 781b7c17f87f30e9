"""Contact at rest: its tangent, its equilibria beside those of damped motion, stability, and a loop that rests on
itself."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from solver import (
    Condition,
    Contact,
    Curve,
    End,
    Frame,
    Initial,
    Numerics,
    PointLoad,
    Rod,
    Scene,
    constant_vector,
    simulate,
)
from solver.arrays import Array
from solver.physics.elasticity import Stretch
from solver.physics.loads.solids import Floor
from solver.scene.ends import FIXED
from solver.scene.layout import nodes_at_rest
from solver.statics.contact import StaticContact
from solver.statics.equations import Equations
from solver.statics.point import BLOCK, FORCE, PSI, Point, X
from solver.statics.stability import negative_modes
from tests.solver.scenes import EJ, LENGTH, ROD, last

D = 0.02
SPRING_ROD = Rod.circular(LENGTH, D, 1e6, 4e5, 1000.0)
SPRING_EJ = 1e6 * pi * D**4 / 64
TURNS = 2.0
PRESS = 8.0 * SPRING_EJ / LENGTH**2


def spring(pitch: float) -> Initial:
    """A coil of two turns around e3, whose turns lie `pitch` apart."""
    at, rise = np.linspace(0.0, 2 * pi * TURNS, 801), pitch / (2 * pi)
    radius = np.sqrt((LENGTH / (2 * pi * TURNS)) ** 2 - rise**2)
    return Initial.through(np.column_stack([radius * np.cos(at), radius * np.sin(at), rise * at]), LENGTH)


def coil(initial: Initial, contact: Contact | None, **changes: object) -> Scene:
    """A spring that is free of stress as it is, clamped at its start."""
    stressless = tuple(Curve.table(np.linspace(0.0, LENGTH, 201), kappa) for kappa in np.transpose(_kappa(initial)))
    scene = Scene(rod=replace(SPRING_ROD, kappa0=stressless), initial=initial, start=End.clamp(), end=End.free(),
                  t_end=1.0, output_interval=1.0, numerics=Numerics("staggered", intervals=40), contact=contact,
                  analysis="static")  # fmt: skip
    return replace(scene, **changes)  # type: ignore[arg-type]


def _kappa(initial: Initial) -> Array:
    return nodes_at_rest(initial, np.linspace(0.0, LENGTH, 201))[2]


LAWS = {
    "without constants": Contact(),
    "eq. (6)": Contact(k1=1e-7, k2=3.0, k3=1e-6, k4=1.0, aperture=2.0, cutoff=2 * D, skip=4 * D, spacing=0.4 * D),
}


ELASTIC = (Stretch(Curve.constant(1e3 * SPRING_EJ / LENGTH**2)),)


@pytest.mark.parametrize("laws", [(), ELASTIC], ids=["", "a rod that can stretch"])
@pytest.mark.parametrize("law", LAWS)
def test_the_tangent_is_the_derivative_of_the_balances(law, laws):
    scene = coil(spring(1.05 * D), LAWS[law])
    equations = Equations(replace(scene, rod=replace(scene.rod, laws=laws)))
    rng, units, n = np.random.default_rng(0), equations.units, len(equations.start.quaternion)
    start = equations.start
    point = Point(start.quaternion, start.base, rng.normal(size=start.F.shape) * units[6], 0.3)
    equations.let_go()
    z = np.zeros((n, BLOCK))
    z[:, PSI], z[1:, FORCE] = rng.normal(size=(n, 3)), rng.normal(size=(n - 1, 3)) * units[6]
    z[0, X] = rng.normal(size=3)

    def at(x: float) -> tuple[Array, Array]:
        left = equations.residual(point.moved(x * z, 0.0))
        return left, np.vstack([equations.stages.base[0, :1], equations.stages.r[0], equations.tip()[None]])

    step = 1e-6
    (ahead, there), (behind, here) = at(step), at(-step)
    z[:, X] = (there - here) / (2 * step)
    equations.look_at(point)
    assert equations.contact.pressing > 100
    _, solver = equations.linearise(point)
    change = (ahead - behind) / (2 * step)
    assert np.abs(solver.solve(change) - z)[:, PSI].max() < 1e-6 * np.abs(z[:, PSI]).max()
    apart = np.abs(solver.solve(change) - z)[:, FORCE].max()
    assert apart < 1e-5 * np.abs(z[:, FORCE]).max()


def pressed(analysis: str, laws: tuple[object, ...]) -> Frame:
    """A spring of two turns between guides that is pressed until these touch."""
    push = (Condition("load", Curve.table([0.0, 1.0], [0.0, -PRESS])),)
    end = End((FIXED, FIXED, push), (FIXED, FIXED, FIXED), frame="lab")
    scene = coil(spring(2.0 * D), LAWS["eq. (6)"], end=end, analysis=analysis)
    scene = replace(scene, rod=replace(scene.rod, laws=laws))
    if analysis == "static":
        return last(scene)
    numerics = Numerics("staggered", intervals=40, dt_max=0.05)
    return last(replace(scene, damping=30.0, t_end=12.0, output_interval=12.0, numerics=numerics))


@pytest.mark.parametrize("laws", [(), ELASTIC], ids=["", "a rod that can stretch"])
def test_a_spring_that_is_pressed_until_its_turns_touch_rests_where_damped_motion_ends(laws):
    static, moved = pressed("static", laws), pressed("dynamic", laws)
    assert (static.strain.max() > 1e-4) == bool(laws)
    assert static.contacts > 20 and static.energy_contact > 0.0
    assert np.abs(static.r - moved.r).max() < 1e-4 * LENGTH  # what is left of the motion
    assert static.min_gap == pytest.approx(moved.min_gap, abs=0.01 * D)
    assert static.energy_contact == pytest.approx(moved.energy_contact, rel=0.1)  # along the steps of the branch


@pytest.mark.parametrize("loads", [(), (Floor(40.0 * EJ / LENGTH**4, normal=(1.0, 0.0, 0.2)),)])
def test_both_counts_of_falling_directions_agree_where_nothing_presses(loads, monkeypatch):
    """From section to section, and of all rotations together: of a straight column under loads that it cannot bear,
    with and without a floor beside it."""
    load = (Condition("load", Curve.constant(0.0)),)
    ends = {"start": End.clamp(), "end": End((FIXED, FIXED, load), (FIXED,) * 3)}
    scene = Scene(rod=ROD, initial=Initial.straight(), **ends, loads=loads, t_end=1.0, output_interval=1.0,
                  numerics=Numerics("staggered", intervals=16), analysis="static")  # fmt: skip
    counts = []
    for part in (0.5, 1.5, 4.0):
        equations = Equations(scene)
        equations.start.F[:, 2] = -part * 4 * pi**2 * EJ / LENGTH**2
        equations.look_at(equations.start)
        banded = negative_modes(equations)
        with monkeypatch.context() as patch:
            patch.setattr(StaticContact, "pressing", 1)
            patch.setattr(StaticContact, "stiffness", lambda _: (np.zeros((17, 3, 17, 3)), np.zeros((17, 17), bool)))
            assert negative_modes(equations) == banded
        counts.append(banded)
    assert counts[0] == 0 < counts[1] < counts[2]


def looped() -> list[Frame]:
    """A rod under a pull that is twisted by its end throws a loop, which comes to rest on itself and is twisted on."""
    thickness = LENGTH / 100
    rod = Rod.circular(LENGTH, thickness, 1e7, 5e6, 1500.0)
    B = 1e7 * pi * thickness**4 / 64
    pull = (Condition("load", Curve.constant(300.0 * B / LENGTH**2)),)
    turn = (Condition("position", Curve.table([0.0, 3.0], [0.0, 36 * pi])),)
    seed = PointLoad(0.5 * LENGTH, constant_vector((0.3 * B / LENGTH**2, 0.0, 0.0)))
    end = End((FIXED, FIXED, pull), (FIXED, FIXED, turn), frame="lab")
    scene = Scene(rod=rod, initial=Initial.straight(direction=(0.0, 0.0, 1.0)), start=End.clamp(), end=end,
                  points=(seed,), t_end=3.0, output_interval=0.1, numerics=Numerics(intervals=80), contact=Contact(),
                  analysis="static")  # fmt: skip
    frames = []
    for frame in simulate(scene):
        frames.append(frame)
        if frame.t > 1.75:
            break
    return frames


def test_a_loop_rests_on_itself():
    frames = looped()
    turns = [frame.Tw + frame.Wr - frame.Lk for frame in frames]
    assert np.abs(turns).max() < 1e-6  # nothing passed through anything, no loop hopped over an end
    final = frames[-1]
    assert final.contacts > 20 and final.min_gap == pytest.approx(0.0, abs=0.1 * LENGTH / 100)
    assert final.negative_modes == 0  # it stood on itself: without contact it is unstable,
    assert all(frame.negative_modes == 1 for frame in frames if 1.05 < frame.t < 1.55)
    assert np.argmin([frame.parameter for frame in frames if frame.t > 0.9]) > 0  # and the way to it leads back
