"""Self-contact in a run: strands are held apart, nothing is searched in vain, and no crossing goes unsaid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import isnan, pi

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import solver.physics.contact.search as search
from solver import (
    Contact,
    Curve,
    DistributedLoad,
    End,
    Initial,
    Numerics,
    Outcome,
    Rod,
    RunFailed,
    Scene,
    simulate,
    warm,
)
from solver.arrays import Array
from solver.methods.staggered import StaggeredMethod
from solver.physics.contact.forces import allowed_fraction, keeps_apart, press
from solver.physics.contact.self_contact import SelfContact
from solver.run.simulation import Simulation
from solver.run.step_control import StepControl
from solver.scene.curve import constant_vector
from solver.scene.layout import nodes_at_rest
from tests.solver.scenes import fixed_steps, moved_clamp

LENGTH, DIAMETER, INTERVALS = 0.3, 0.004, 40
RISE = 0.06
"""Sine of the slope at which the loop's strands pass over each other."""
CONTACT = Contact(k1=3e-7, k2=3.0, k3=1e-4, k4=1.0, aperture=pi / 2, cutoff=0.01, skip=0.03, spacing=1e-3)
HELD = Curve.constant(0.0)
CROSSED = 1.0
"""Tw + Wr - Lk jumps by 2 where a rod passes through itself; half of that is no error of the discretization."""


def loop(rise: float = RISE) -> Callable[[Array], Array]:
    """A loop whose tangent turns by 3/2 pi, its strands crossing one above the other."""
    fine = np.linspace(0.0, LENGTH, 2001)
    turned = CubicSpline(fine, np.exp(-(((fine - LENGTH / 2) / 0.06) ** 2))).antiderivative()(fine)
    angle = 1.5 * pi * (turned / turned[-1] - 0.5)
    flat = np.sqrt(1 - rise**2)
    tangent = np.column_stack([flat * np.cos(angle), flat * np.sin(angle), np.full_like(angle, rise)])
    line = CubicSpline(fine, tangent).antiderivative()
    return lambda s: np.asarray(line(s), dtype=float)


def looped(contact: Contact | None, down: float, t_end: float = 1.0) -> Scene:
    """The loop, free of stress as it is; its upper end is moved down by `down`, strand onto strand."""
    initial = Initial(loop(), a1=(0.0, 0.0, 1.0))
    fine = np.linspace(0.0, LENGTH, 321)
    _, _, kappa = nodes_at_rest(initial, fine)
    one, two, three = (Curve.table(fine, component, "cubic") for component in kappa.T)
    rod = Rod.circular(LENGTH, DIAMETER, 5e7, 2e7, 1500.0, kappa0=(one, two, three))
    path = Curve.table([0.0, 1.0], [0.0, -down], "smoothstep")
    return Scene(
        rod=rod, initial=initial, start=End.clamp(), end=moved_clamp(HELD, HELD, path), t_end=t_end,
        output_interval=0.05, damping=20.0, contact=contact, numerics=fixed_steps(INTERVALS, 0.02),
    )  # fmt: skip


@pytest.fixture
def bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run of ever smaller steps fails instead of going on."""
    steps = 0
    original = StepControl.step_from

    def counted(self: StepControl, t: float, limit: float, blow: float) -> tuple[float, float]:
        nonlocal steps
        steps += 1
        assert steps < 20000, f"the run does not get on: t = {t}, the next step at most {limit}"
        return original(self, t, limit, blow)

    monkeypatch.setattr(StepControl, "step_from", counted)


def defects(scene: Scene) -> list[float]:
    return [frame.Tw + frame.Wr - frame.Lk for frame in simulate(scene)]


@pytest.mark.usefixtures("bounded")
def test_strands_pressed_together_hold_each_other_apart() -> None:
    frames = list(simulate(looped(replace(CONTACT, k1=3e-6), 0.02)))
    assert frames[0].contacts == 0
    assert frames[-1].contacts > 0
    assert frames[-1].energy_contact > 0
    assert max(abs(f.Tw + f.Wr - f.Lk) for f in frames) < 0.01
    assert min(f.min_gap for f in frames) > -0.5 * DIAMETER


@pytest.mark.usefixtures("bounded")
def test_without_contact_the_same_strands_do_cross() -> None:
    assert abs(defects(looped(None, 0.05))[-1]) == pytest.approx(2.0, abs=0.01)


@pytest.mark.usefixtures("bounded")
@pytest.mark.parametrize(
    "contact",
    [
        replace(CONTACT, k1=1e-11),
        replace(CONTACT, k1=0.0, k3=0.0),
        replace(CONTACT, spacing=5e-3),
        replace(CONTACT, k1=1e-9, spacing=5e-3),
    ],
    ids=["soft", "no force at all", "points far apart", "soft and far apart"],
)
def test_a_rod_never_crosses_itself_without_saying_so(contact: Contact) -> None:
    try:
        told = defects(looped(contact, 0.05))
    except RunFailed as failure:
        assert failure.outcome in (Outcome.ROD_CROSSED_ITSELF, Outcome.STEP_TOO_SMALL)
    else:
        assert max(map(abs, told)) < CROSSED


class Calls:
    """How often the searches are called."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.number = {"find_pairs": 0, "smallest_distance": 0}
        for name in self.number:
            self._count(monkeypatch, name)

    def _count(self, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
        original = getattr(search, name)

        def counted(*args: object) -> object:
            self.number[name] += 1
            return original(*args)

        monkeypatch.setattr(search, name, counted)


def bent(contact: Contact | None) -> Scene:
    """A cantilever that a steady load bends by far less than pi."""
    load = DistributedLoad(constant_vector((0.02, 0.0, 0.0)))
    return Scene(
        rod=Rod.circular(LENGTH, DIAMETER, 5e7, 2e7, 1500.0), initial=Initial.straight(), start=End.clamp(),
        end=End.free(), t_end=0.3, output_interval=0.1, damping=5.0, distributed=(load,), contact=contact,
        numerics=fixed_steps(INTERVALS, 0.01),
    )  # fmt: skip


def test_no_pair_is_searched_while_the_bending_bound_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    list(simulate(bent(CONTACT)))  # which compiles what it needs
    calls = Calls(monkeypatch)
    simulation = simulate(bent(CONTACT))
    frames = list(simulation)
    assert np.abs(frames[-1].r[:, 0]).max() > 0.01
    assert simulation.statistics.steps > 20
    assert calls.number == {"find_pairs": 0, "smallest_distance": 0}
    assert all(isnan(frame.min_gap) for frame in frames)


def test_a_scene_without_contact_searches_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    warm()
    calls = Calls(monkeypatch)
    frames = list(simulate(bent(None)))
    assert calls.number == {"find_pairs": 0, "smallest_distance": 0}
    assert all(isnan(frame.min_gap) and frame.contacts == 0 for frame in frames)


def test_strands_far_apart_are_searched_now_and_then_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """A proven gap holds until somebody has used up a part of it: fewer searches than steps."""
    warm()
    calls = Calls(monkeypatch)
    simulation = simulate(looped(CONTACT, 0.002, t_end=0.5))
    frames = list(simulation)
    assert all(frame.contacts == 0 for frame in frames)
    assert calls.number["smallest_distance"] - len(frames) < simulation.statistics.steps / 4


def test_a_helix_that_swings_far_from_itself_is_not_held_back() -> None:
    """Its steps were so short that no point went farther than half a diameter: points a little farther along the rod
    than the law looks are as near as that, however little the rod bends."""
    def steps(contact: Contact | None) -> int:
        rod = Rod.circular(0.2, 8e-5, 4e9, 1.5e9, 1300.0, kappa0=tuple(map(Curve.constant, (50.0, 0.0, 8.0))))
        scene = Scene(rod=rod, initial=Initial.straight(direction=(0.0, 0.0, -1.0)), start=End.clamp(), end=End.free(),
                      t_end=0.3, output_interval=0.03, gravity=(0.0, 0.0, -9.81), damping=8.0, contact=contact,
                      numerics=Numerics(method="staggered", intervals=32, increment_tolerance=0.25))  # fmt: skip
        run = simulate(scene)
        assert not any(frame.energy_contact for frame in run)
        return run.statistics.steps

    assert steps(Contact()) < 1.3 * steps(None)


def test_a_fine_thread_lists_no_neighbours_along_itself_however_coarse_the_mesh() -> None:
    """A curl of hair, .08 mm thick in turns of 25 mm, has points that are near along it within every interval."""
    turns, s = 12.0, np.linspace(0.0, LENGTH, 49)
    turn = 2.0 * pi * turns / LENGTH
    radius = 0.8 / turn
    curl = np.column_stack([radius * np.cos(turn * s), radius * np.sin(turn * s), 0.6 * s])
    contact = SelfContact(Contact(), Rod.circular(LENGTH, 8e-5, 4e9, 1.2e9, 1300.0), s, stages=1)
    swung = np.cos(40.0 * s)[:, None] * np.ones(3)
    contact.prepare(2.0 * pi * turns, curl, swung, 1e-3)
    assert contact.touch.points.slack.max() > 10.0 * 8e-5 / 2.0
    assert contact.touch.pairs.counts.tolist() == [0, 0]
    assert refusal_of(contact, 2.0 * pi * turns, curl, swung) == ""


def test_a_rod_that_moves_as_a_whole_is_searched_once_and_its_steps_may_be_as_long_as_they_like() -> None:
    """A hook that turns about an axis by half a radian a step, and flies on: no two parts of it come nearer."""
    s = np.linspace(0.0, LENGTH, 49)
    angle = 1.5 * pi * s / LENGTH
    hook = LENGTH / 6.0 * np.column_stack([np.sin(angle), 1.0 - np.cos(angle), angle])
    spin, flight = np.array([0.0, 0.0, 50.0]), np.array([40.0, 0.0, 0.0])
    contact = SelfContact(Contact(), Rod.circular(LENGTH, 1e-3, 4e9, 1.2e9, 1300.0), s, stages=1)

    def at(t: float) -> tuple[Array, Array]:
        turned = Rotation.from_rotvec(spin * t).apply(hook)
        return turned + flight * t, np.cross(spin, turned) + flight

    contact.prepare(1.5 * pi, *at(0.0), 0.01)
    searched = contact.touch.points.checked.copy()
    for i in range(1, 4):
        assert contact.refusal(1.5 * pi, lambda t=0.01 * i: at(t)) == ""  # type: ignore[misc]
        assert contact.step_limit > 10.0
        contact.prepare(1.5 * pi, *at(0.01 * i), 0.01)
    assert np.array_equal(contact.touch.points.checked, searched)


def test_the_smallest_gap_is_between_surfaces() -> None:
    frame = next(iter(simulate(looped(CONTACT, 0.001, t_end=0.05))))
    s = np.linspace(0.0, LENGTH, 1501)
    r = loop()(s)
    apart = [np.linalg.norm(r[b:] - r[:-b], axis=1).min() for b in range(150, 1500)]
    # points 1 mm apart on crossing strands miss the nearest pair by less than 0.5 mm along each
    nearest = float(min(apart))
    assert nearest <= frame.min_gap + DIAMETER < np.hypot(nearest, 0.71e-3) + 1e-5


def state_of(line: Callable[[Array], Array], s: Array) -> tuple[float, Array, Array]:
    """Total bending, positions and velocities of nodes at rest on a line."""
    r, _, kappa = nodes_at_rest(Initial(line, a1=(0.0, 0.0, 1.0)), s)
    return float(np.hypot(kappa[:, 0], kappa[:, 1]).mean() * s[-1]), r, np.zeros_like(r)


def contact_of_the_loop(contact: Contact = CONTACT) -> tuple[SelfContact, Array]:
    s = np.linspace(0.0, LENGTH, INTERVALS + 1)
    return SelfContact(contact, Rod.circular(LENGTH, DIAMETER, 5e7, 2e7, 1500.0), s, stages=1), s


def refusal_of(contact: SelfContact, bending: float, r: Array, velocity: Array) -> str:
    return contact.refusal(bending, lambda: (r, velocity))


def test_a_step_that_swaps_the_strands_is_refused() -> None:
    contact, s = contact_of_the_loop()
    contact.prepare(*state_of(loop(RISE), s), 0.01)
    assert refusal_of(contact, *state_of(loop(RISE), s)) == ""
    assert refusal_of(contact, *state_of(loop(-RISE), s)) != ""


def test_a_step_in_which_strands_slip_into_each_other_between_points_is_refused() -> None:
    """Found under stress. The strands are 0.19 m times the rise apart; D/4 is 1 mm."""
    contact, s = contact_of_the_loop(replace(CONTACT, spacing=5e-3, cutoff=2e-3))
    contact.prepare(*state_of(loop(0.0058), s), 0.01)
    assert refusal_of(contact, *state_of(loop(0.0056), s)) == ""
    assert "between contact points" in refusal_of(contact, *state_of(loop(0.0049), s))


def test_a_step_that_brings_a_straight_rod_to_touch_itself_is_refused() -> None:
    contact, s = contact_of_the_loop()
    contact.prepare(*state_of(lambda s: np.outer(s, [1.0, 0.0, 0.0]), s), 0.01)
    assert refusal_of(contact, *state_of(loop(0.01), s)) == "the rod came near itself within one step"


def test_strands_that_approach_limit_the_next_step_to_part_of_the_time_to_touch() -> None:
    contact, s = contact_of_the_loop()
    bending, r, velocity = state_of(loop(0.04), s)
    speed = 0.5
    velocity[: INTERVALS // 2, 2], velocity[INTERVALS // 2 :, 2] = 0.5 * speed, -0.5 * speed
    contact.prepare(bending, r, velocity, 0.01)
    assert refusal_of(contact, bending, r, velocity) == ""
    gap = contact.smallest_gap(bending, r) + DIAMETER
    assert 0.0 < contact.step_limit < gap / speed


def test_a_step_that_is_refused_is_tried_again_from_where_it_began() -> None:
    """The second trial's points are compared with those of the state, not with those of the first trial."""
    numerics = replace(fixed_steps(INTERVALS, 0.02), method="staggered")
    simulation = Simulation(replace(looped(replace(CONTACT, k1=3e-6), 0.02), numerics=numerics))
    while simulation.t < 0.3:
        simulation.advance()
    method = simulation._method
    assert isinstance(method, StaggeredMethod)
    points = method.contact.touch.points
    method.try_step(simulation.t, 0.01)
    before = points.start.copy()
    assert method.contact.touch.pairs.counts[0] > 0
    method.refusal()
    method.try_step(simulation.t, 0.005)
    assert np.array_equal(points.start, before)


def test_a_guess_that_closes_more_than_half_of_a_gap_is_told_from_one_that_does_not() -> None:
    contact, s = contact_of_the_loop()
    contact.prepare(*state_of(loop(0.04), s), 0.01)
    assert keeps_apart(contact.touch.points, contact.touch.pairs, state_of(loop(0.04), s)[1])
    assert keeps_apart(contact.touch.points, contact.touch.pairs, state_of(loop(0.036), s)[1])
    assert not keeps_apart(contact.touch.points, contact.touch.pairs, state_of(loop(0.02), s)[1])


def test_no_update_of_newtons_closes_a_gap_that_presses() -> None:
    contact, s = contact_of_the_loop()
    _, r, velocity = state_of(loop(0.04), s)
    contact.prepare(*state_of(loop(0.04), s), 0.01)
    touch = contact.touch
    press(touch, r[None], velocity[None], 0)
    assert touch.pressing.many[0] > 0
    change = state_of(loop(0.015), s)[1] - r
    fraction = allowed_fraction(touch, change, 0)
    assert 0.0 < fraction < 1.0
    gap = touch.pressing.gap[0, : touch.pressing.many[0]].min()
    press(touch, (r + fraction * change)[None], velocity[None], 0)
    assert 0.1 * gap < touch.pressing.gap[0, : touch.pressing.many[0]].min() < gap
