"""The quick scenes of the validation, each row an aim."""

from __future__ import annotations

from importlib import import_module

import pytest


@pytest.mark.parametrize("scene", ["greenhill", "elastica", "statics", "energy", "writhe"])
def test_every_aim_of_the_scene_is_met(scene):
    missed = [row for row in import_module(f"validation.{scene}").rows() if not row.passed]
    assert not missed
