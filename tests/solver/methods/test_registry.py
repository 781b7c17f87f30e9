"""The registry of methods is what everything else goes by."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args, get_type_hints

import pytest

from service.cases.case import NumericsSpec
from solver import Contact, Numerics
from solver.methods.registry import METHODS, discretized
from tests.solver.methods.test_one_axis import CANTILEVER, TOUCHES


def test_a_scene_and_a_case_may_ask_for_just_the_methods_there_are() -> None:
    assert list(get_args(get_type_hints(Numerics)["method"])) == list(METHODS)
    assert list(get_args(get_type_hints(NumericsSpec)["method"])) == list(METHODS)


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("contact", [None, TOUCHES], ids=["without contact", "with contact"])
def test_what_is_compiled_before_a_run_is_told_by_whether_it_can_touch_itself(
    name: str, contact: Contact | None
) -> None:
    """One class of a method, at the most, takes scenes with contact; if there is another, the others."""
    kinds = [kind.touches for kind in METHODS[name]]
    assert len(kinds) == len(set(kinds))
    scene = replace(CANTILEVER, contact=contact, numerics=replace(CANTILEVER.numerics, method=name))  # type: ignore[arg-type]
    assert discretized(scene).touches is (contact is not None or kinds == [True])
