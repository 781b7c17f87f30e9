"""Remedies: what they say can be done, with a tolerance as without one."""

from __future__ import annotations

import re

import pytest

from outcomes import Outcome

BOX_ONLY = {Outcome.SHOOTING_LOST_DIGITS}
"""What no run to a tolerance ends with: it uses the staggered method."""


@pytest.mark.parametrize("outcome", sorted(set(Outcome) - BOX_ONLY))
def test_a_remedy_that_names_mesh_or_steps_says_what_to_do_with_a_tolerance(outcome: Outcome):
    if re.search(r"\bintervals\b|\bdt_max\b", outcome.remedy):
        assert re.search(r"\btolerance\b", outcome.remedy)


@pytest.mark.parametrize("outcome", [Outcome.STEP_TOO_SMALL, Outcome.ROD_STRETCHED])
def test_ends_that_pull_the_rod_taut_have_a_remedy(outcome: Outcome):
    assert "nearer to each other than" in outcome.remedy
