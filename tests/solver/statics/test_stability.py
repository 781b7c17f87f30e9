"""Stability of equilibria: in how many directions the energy falls or stays, and what a run says of it."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from solver import (
    FIXED,
    FREE,
    Condition,
    Curve,
    DistributedLoad,
    End,
    Initial,
    Numerics,
    Outcome,
    PointLoad,
    RunFailed,
    Scene,
    UserLoad,
    constant_vector,
    simulate,
)
from solver.arrays import Array
from solver.physics.elasticity import Stretch
from solver.physics.loads.solids import Floor
from solver.run.equilibria import Equilibria
from solver.scene.layout import nodes_at_rest, sampled
from solver.statics import stability
from solver.statics.elimination import falling_in_turn
from solver.statics.equations import Equations
from solver.statics.stability import of_loads
from tests.solver.scenes import (
    ARC,
    DENSITY,
    DIAMETER,
    EJ,
    GJ,
    LENGTH,
    ROD,
    arc,
    last,
    moved_clamp,
)
from tests.solver.statics.resting import DENSITIES, PRESSED, ZERO, ramp, static


@pytest.mark.parametrize(("loads", "turning"), [
    (PRESSED["weight"], False), (PRESSED["pin and clamp"], False),
    ({"distributed": (DistributedLoad(DENSITIES),), "points": (PointLoad(LENGTH, DENSITIES),)}, False),
    (PRESSED["lab"], True), (PRESSED["tip, lab"], True),  # their moments
    (PRESSED["following"], True), (PRESSED["current"], True),
    ({"end": End((FREE, FREE, (Condition("load", ramp(-15.0 * EJ)),)), (FREE, FREE, FREE))}, True),
    ({"end": End((FREE, FREE, FREE), (FREE, (Condition("load", ramp(EJ)),), FREE))}, True),
    ({"end": End((FREE, FREE, FREE), (FIXED, (Condition("load", ramp(EJ)),), FIXED))}, False),
    ({"points": (PointLoad(LENGTH, moment=(Curve.constant(0.0), Curve.constant(0.0), ramp(EJ))),)}, True),
])  # fmt: skip
def test_of_forces_that_turn_with_the_rod_the_run_says_that_modes_prove_nothing(
    loads: dict[str, object], turning: bool
) -> None:
    run = Equilibria(static(numerics=Numerics(intervals=4), **loads))
    while not run.finished:
        run.advance()
    assert any("turn with the rod" in sentence for sentence in run.remarks.sentences()) == turning


class Whirl(UserLoad):
    """A force about the axis of the straight rod: it does work on a circle, so it has no potential."""

    def force(self, t: float, s: Array, r: Array, V: Array) -> Array:
        return min(t, 1.0) * 100.0 * EJ * np.column_stack([-r[:, 1], r[:, 0], 0.0 * s])


def test_of_forces_without_a_potential_the_run_says_so() -> None:
    run = Equilibria(static(numerics=Numerics(intervals=4), gravity=(1e-3, 0.0, 0.0), loads=(Whirl(),)))
    while not run.finished:
        run.advance()
    assert any("have no potential" in sentence for sentence in run.remarks.sentences())


def twisted(moment: float, intervals: int) -> int:
    """Falling directions of a straight rod between clamps twisted by a moment (in EJ/L), without thrust."""
    twist = Curve.table([0.0, LENGTH], [0.0, moment * EJ / GJ])
    scene = static(initial=Initial.straight(twist=twist), end=End.slider(), numerics=Numerics(intervals=intervals))
    return next(iter(simulate(scene))).negative_modes


def test_stability_is_lost_at_greenhills_torque_in_two_directions() -> None:
    # second order in ds: the error is some (M ds / EJ)^2 / 24 of the torque
    assert [twisted(m, 40) for m in (5.0, 8.98, 8.99, 15.0)] == [0, 0, 2, 2]


def test_stability_is_lost_at_eulers_load_and_a_seed_leads_to_the_stable_branch() -> None:
    load = PointLoad(LENGTH, (ZERO, ZERO, ramp(-4.0 * EJ)))
    straight = list(simulate(static(points=(load,), output_interval=0.05)))
    lost = [frame.negative_modes for frame in straight]
    assert lost == [0 if 4.0 * frame.t < pi**2 / 4.0 else 2 for frame in straight]
    seeded = last(static(points=(load,), distributed=(DistributedLoad(constant_vector((1e-4 * EJ, 0.0, 0.0))),)))
    assert seeded.r[-1, 0] > 0.5 * LENGTH
    assert seeded.negative_modes == 0


@pytest.mark.parametrize("numerics", [Numerics(intervals=10), Numerics("staggered", tolerance=1e-2)])
@pytest.mark.parametrize(("load", "frames"), [(4.0, 8), (2.0, 0)])
def test_a_run_says_from_when_on_its_equilibria_are_unstable(load: float, frames: int, numerics: Numerics) -> None:
    """Beyond pi^2 / 4 EJ/L^2, which is at t = .617 of 4."""
    pressed = PointLoad(LENGTH, (ZERO, ZERO, ramp(-load * EJ)))
    run = simulate(static(points=(pressed,), output_interval=0.05, numerics=numerics))
    assert len(list(run)) == 21
    told = {name: value for name, value in run.attributes().items() if "unstable" in name}
    assert told == ({"unstable_frames": frames, "first_unstable": pytest.approx(0.65)} if frames else {})
    assert any("is unstable" in note for note in run.notes()) == bool(frames)


def at_start(scene: Scene) -> Equations:
    """Of its initial shape under some force along it, let go."""
    equations = Equations(scene)
    equations.let_go()
    equations.start.F[:, 2] = -20.0 * EJ / LENGTH**2
    equations.linearise(equations.start)
    return equations


@pytest.mark.parametrize("thrust", [0.5, 5.0, 30.0, 70.0])
def test_a_cantilever_has_a_falling_direction_for_each_load_of_euler_below_its_own(thrust: float) -> None:
    """pi^2/4, 9 pi^2/4, 25 pi^2/4, each in two planes."""
    equations = at_start(static())
    equations.start.F[:, 2] = -thrust * EJ / LENGTH**2
    equations.linearise(equations.start)
    assert stability.negative_modes(equations) == 2 * sum(thrust > (k * np.pi / 2.0) ** 2 for k in (1, 3, 5))


ALONG, HELD = (FREE, FREE, FIXED), (FIXED, FIXED, FIXED)


@pytest.mark.parametrize("stiffness", [1.0, 1e4, 1e8])
@pytest.mark.parametrize(("start", "end"), [
    (End.clamp(), End.free()), (End.free(), End.clamp()), (End.free(), End.free()), (End.pin(), End.pin()),
    (End.slider(), End(ALONG, (FREE, FREE, FREE), "lab")), (End(ALONG, HELD, "lab"), End.slider()),
])  # fmt: skip
@pytest.mark.parametrize("law", [(), (Stretch(Curve.constant(1e12 * EJ)),)])
def test_counted_in_turn_or_together_as_many_directions_fall(
    start: End, end: End, stiffness: float, law: tuple[Stretch, ...]
) -> None:
    """Loads by place on some of the segments, as of a floor, and of either sign. (That they move a stiff rod along
    itself by stretching it is left out of the one.)"""
    scene = static(start=start, end=end, initial=ARC, rod=replace(ROD, laws=law), numerics=Numerics(intervals=24))
    equations, random = at_start(scene), np.random.default_rng(7)
    length = float(equations.s[-1])
    for _ in range(20):
        axes = np.linalg.qr(random.normal(size=(24, 3, 3)))[0]
        K = axes @ (random.normal(size=(24, 3, 1)) * axes.transpose(0, 2, 1))
        K *= stiffness * EJ / LENGTH**3 * (random.random(24) < 0.5)[:, None, None]
        for softest in (stability.NEUTRAL, -stability.NEUTRAL):
            D, B = stability._second_variation(equations, softest)
            bands, (G, W, ties) = stability._in_bands(D, B), stability._conditions(equations)
            together = stability._all_together(equations, K, bands, G, W, softest) - ties
            by_place = stability.no_softer(K, softest) * (length**3 / equations.stiffness)
            assert falling_in_turn(equations, D, B, by_place) == together


@pytest.mark.parametrize(("weight", "modes"), [(0.0, (0, 2)), (1.0, (0, 1)), (-0.1, (1, 1))])
def test_free_spin_and_free_swing_are_neutral_and_not_unstable(weight: float, modes: tuple[int, int]) -> None:
    """A rod bent between two pins may spin about its axis; it swings about the line of its pins, with its weight in
    the plane of its bow stably if it hangs and unstably if it stands."""
    start, middle, end = arc(np.array([0.0, 0.5 * LENGTH, LENGTH]))
    down = middle - 0.5 * (start + end)
    mass = DENSITY * pi / 4.0 * DIAMETER**2
    gravity = weight * EJ / LENGTH**3 / mass * down / np.linalg.norm(down)
    rest = last(static(initial=ARC, start=End.pin(), end=End.pin(), gravity=tuple(gravity)))
    assert (rest.negative_modes, rest.neutral_modes) == modes


def test_a_small_load_leads_a_rod_that_is_pressed_by_its_clamps_to_the_stable_branch() -> None:
    """As the guide advises where a symmetric rod buckles. The deflection of the elastica: see `validation.euler`."""
    seed = DistributedLoad((Curve.constant(1e-6 * EJ / LENGTH**3), ZERO, ZERO), (ZERO, ZERO, ZERO))
    rest = last(static(end=moved_clamp(ZERO, ZERO, ramp(-0.4 * LENGTH)), distributed=(seed,),
                       numerics=Numerics("staggered", intervals=64)))  # fmt: skip
    assert (rest.negative_modes, rest.neutral_modes) == (0, 0)
    assert_allclose(np.abs(rest.r[32, 0]), 0.348713 * LENGTH, rtol=1e-3)


def test_a_clamped_coil_that_is_free_of_stress_has_no_neutral_direction() -> None:
    """However many turns: it is curved by nature, so that even a spin about its own axis costs energy."""
    radius, angle, nodes = 0.02 * LENGTH, 12 * pi / LENGTH, np.linspace(0.0, LENGTH, sampled(64) + 1)

    def coil(s: Array) -> Array:
        return np.column_stack([radius * np.cos(angle * s), radius * np.sin(angle * s),
                                s * np.sqrt(1.0 - (radius * angle) ** 2)])  # fmt: skip

    initial = Initial(coil)
    kappa1, kappa2, kappa3 = (Curve.table(nodes, column, "cubic") for column in nodes_at_rest(initial, nodes)[2].T)
    rest = last(static(rod=replace(ROD, kappa0=(kappa1, kappa2, kappa3)), initial=initial,
                       numerics=Numerics("staggered", intervals=64)))  # fmt: skip
    assert (rest.negative_modes, rest.neutral_modes) == (0, 0)


@pytest.mark.parametrize("a1", [None, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.6, 0.8, 0.0)])
@pytest.mark.parametrize(("solid", "across"), [(Floor(1000.0, -0.99), 0.0),  # below its tip, and beside it
                                               (Floor(1e4, -0.05, (-1.0, 0.0, 0.0)), 0.6)])  # fmt: skip
def test_a_rod_that_hangs_onto_a_solid_is_stable_however_its_section_is_turned(
    solid: Floor, across: float, a1: tuple[float, float, float] | None
) -> None:
    hanging = static(
        initial=Initial.straight(direction=(0.0, 0.0, -1.0), a1=a1), gravity=(0.0, 0.0, -3.0), loads=(solid,),
        points=(PointLoad(LENGTH, (ramp(across), ZERO, ZERO)),), numerics=Numerics(intervals=100),
    )  # fmt: skip
    frames = list(simulate(hanging))
    assert [(frame.negative_modes, frame.neutral_modes) for frame in frames] == [(0, 0)] * len(frames)


def on_a_floor(across: float) -> Scene:
    """A rod that nothing holds but the floor it lies on, with a force to the side on its middle."""
    return static(
        initial=Initial.straight(origin=(0.0, 0.0, -1e-3), direction=(1.0, 0.0, 0.0)), end=End.free(), start=End.free(),
        gravity=(0.0, 0.0, -9.81), loads=(Floor(2000.0),),
        points=(PointLoad(0.5 * LENGTH, (ZERO, ramp(across), ZERO)),),
    )  # fmt: skip


def test_a_rod_that_lies_on_a_floor_stays_where_it_is_and_may_slide_and_roll() -> None:
    frame = last(on_a_floor(0.0))
    weight = DENSITY * 0.25 * pi * DIAMETER**2 * 9.81
    assert_allclose(frame.r[:, 2], -weight / 2000.0, rtol=1e-6)
    assert_allclose(frame.r[:, 0], np.linspace(0.0, LENGTH, len(frame.r)), atol=1e-9)
    assert_allclose(frame.r[:, 1], 0.0, atol=1e-9)
    assert (frame.negative_modes, frame.neutral_modes) == (0, 4)


def test_a_rod_that_loads_push_along_a_floor_ends_by_name() -> None:
    with pytest.raises(RunFailed, match="nothing holds the rod against its loads") as failure:
        last(on_a_floor(1e-3))
    assert failure.value.outcome is Outcome.SINGULAR_SYSTEM


def test_a_thin_strip_that_is_seeded_buckles_sideways_at_prandtls_load() -> None:
    """Its stiffnesses are as 1 to 1e4; a step ended 1e-9 before a frame, and none was as short as that."""
    wide, thin, GJ = 500.0, 0.05, 0.04
    rod = replace(ROD, stiffness=tuple(Curve.constant(x) for x in (wide, thin, GJ)))
    prandtl = 4.0126 * np.sqrt(thin * GJ) / LENGTH**2
    load = PointLoad(LENGTH, (ZERO, ZERO, ramp(-1.2 * prandtl)))
    seed = DistributedLoad(constant_vector((0.0, 1e-5 * thin, 0.0)), constant_vector((0.0, 0.0, 0.0)))
    initial = Initial.straight(direction=(1.0, 0.0, 0.0), a1=(0.0, 1.0, 0.0))
    frames = list(simulate(static(rod=rod, initial=initial, points=(load,), distributed=(seed,), output_interval=0.05)))
    before, behind = (next(frame for frame in frames if frame.parameter > part / 1.2) for part in (0.9, 1.1))
    assert abs(before.r[-1, 1]) < 1e-3 * LENGTH < 0.1 * LENGTH < abs(behind.r[-1, 1])
    assert not any(frame.negative_modes for frame in frames)


def test_loads_by_place_count_like_as_many_springs_on_the_nodes() -> None:
    """The centre of a segment is half way between its nodes, and these are moved by the rotations before them."""
    n, rng = 5, np.random.default_rng(1)
    K, steps = rng.normal(size=(n, 3, 3)), rng.normal(size=(n, 3, 3))
    K += K.transpose(0, 2, 1)
    moved = np.zeros((3 * n, 3 * n + 3))  # the centres by the place of the start and the rotations
    for i in range(n):
        moved[3 * i : 3 * i + 3] = np.hstack([np.eye(3), *(
            (j < i or 0.5 * (j == i)) * steps[j].T for j in range(n))])  # fmt: skip
    springs = np.zeros((3 * n, 3 * n))
    for i in range(n):
        springs[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = K[i]
    whole = moved.T @ springs @ moved
    by_rotations, by_both, by_place = of_loads(K, steps, 0.0)
    blocks = np.kron(np.tril(np.ones((n, n))), np.ones((3, 3))) > 0.0
    assert_allclose(by_rotations[blocks], whole[3:, 3:][blocks], atol=1e-12)
    assert_allclose(by_both, whole[3:, :3], atol=1e-12)
    assert_allclose(by_place, whole[:3, :3], atol=1e-12)


def test_a_buckle_that_may_turn_about_a_twisted_round_rod_for_next_to_nothing_is_followed() -> None:
    """Its phase about the axis is held by the seed alone, the less the more turns it has; that stiffness goes through
    zero, as that of no other direction does, and the other way round the energy hardly differs."""
    seed = DistributedLoad((Curve.constant(3e-3 * EJ / LENGTH**3), ZERO, ZERO), (ZERO, ZERO, ZERO))
    turned = End(moved_clamp(ZERO, ZERO, ramp(-0.1 * LENGTH)).translation,
                 (FIXED, FIXED, (Condition("position", ramp(2.0 * pi * 6.9)),)), "lab")  # fmt: skip
    rest = last(static(end=turned, distributed=(seed,), numerics=Numerics("staggered", intervals=64)))
    assert rest.parameter == 1.0
    assert_allclose(rest.Tw + rest.Wr, 6.9, atol=1e-3)
