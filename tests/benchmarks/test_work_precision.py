"""What the work-precision benchmark makes of its points, and where the peers' clamps are felt."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from benchmarks.work_precision import table
from benchmarks.work_precision.cantilever import Elements, carried_frames, straight
from benchmarks.work_precision.measure import BOX, LONGEST, PYELASTICA, STAGGERED, Measured, Point, Skipped, cheapest
from benchmarks.work_precision.measure import refuse_if_long as refuse
from validation.free_flight import curled
from validation.rods import LENGTH


def point(solver: str, cpu: float, error: float, value: float = 1.0) -> Point:
    return Point("scene", "tip", solver, "", cpu, error, value)


POINTS = [
    point(BOX, 1.0, 1e-2, 1.01), point(BOX, 4.0, 1e-3, 1.001),
    point(STAGGERED, 2.0, 2e-3, 1.002), point(STAGGERED, 3.0, 5e-4, 1.0005),
    point(PYELASTICA, 500.0, 1.5e-3), Point("scene", "", PYELASTICA, "", missing="would take too long"),
]  # fmt: skip


def test_work_is_that_of_the_cheapest_run_with_no_larger_error() -> None:
    assert table.work(POINTS, BOX, 1e-2) == 1.0
    assert table.work(POINTS, BOX, 9e-3) == 4.0
    assert table.work(POINTS, BOX, 1e-4) == inf


def test_a_peer_is_compared_at_equal_error_and_the_method_that_did_it_named() -> None:
    assert any("| scene | tip | PyElastica | 1.5e-03 | 500 | staggered, 3 s | 167 | 167 | 100 |" == line
               for line in table.at_equal_error(POINTS))  # fmt: skip


def test_the_better_method_is_the_cheaper_one_at_an_error_that_both_reach() -> None:
    told = "| 1.0e-03 | 4 | 3 | not reached | not reached | not reached | staggered, 1.3 times |"
    assert any(told in line for line in table.summary(POINTS))


def test_methods_agree_only_within_what_their_last_refinements_changed() -> None:
    apart = [*POINTS, point(STAGGERED, 9.0, 5e-4, 1.2), point(STAGGERED, 9.0, 5e-4, 1.2)]
    assert table.agreement(POINTS)[-2].endswith("| yes |")
    assert table.agreement(apart)[-2].endswith("| no |")


def test_a_run_that_was_not_made_is_said_to_be_so() -> None:
    assert any("would take too long" in line for line in table.results(POINTS))
    with pytest.raises(Skipped, match="CPU s"):
        refuse(1.0, int(2 * LONGEST))


def test_the_cheapest_repetition_of_each_quantity_is_kept() -> None:
    costs = iter((0.3, 0.1, 0.2))
    assert cheapest(lambda: {"tip": Measured(next(costs), 1.0, 1.0)})["tip"].cpu == 0.1


@pytest.mark.parametrize("corrected", [True, False])
def test_the_rod_ends_where_it_should_and_its_clamp_is_felt_in_the_middle_of_the_held_element(corrected: bool) -> None:
    elements = Elements(10, corrected)
    nodes = elements.nodes(straight)
    assert nodes[-1, 2] == pytest.approx(LENGTH)
    felt = 0.5 * (nodes[0, 2] + nodes[1, 2])
    assert felt == pytest.approx(0.0 if corrected else 0.5 * elements.length, abs=1e-12)


def test_carried_frames_follow_the_tangents_without_twist() -> None:
    tangents = Elements(40, True).tangents(curled)
    frames = carried_frames(tangents, np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]))
    assert np.abs(frames[:, :, 0] - tangents).max() <= 1e-12
    turned = np.einsum("nji,njk->nik", frames[:-1], frames[1:])
    assert np.abs(turned[:, 2, 1] - turned[:, 1, 2]).max() <= 1e-12
