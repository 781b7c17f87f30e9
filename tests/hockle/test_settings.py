"""`--set KEY=VALUE` as people write it."""

from __future__ import annotations

import pytest

from hockle.settings import parse_settings


@pytest.mark.parametrize(
    ("written", "value"),
    [("1e-3", 1e-3), (".1", 0.1), ("5.", 5.0), ("-.5", -0.5), ("+2.5e-3", 2.5e-3), ("true", True), ("[0, 1]", [0, 1]),
     ("box", "box"), ("007", "007"), ("1.2.3", "1.2.3"), (".", ".")],
)  # fmt: skip
def test_a_value_is_json_a_decimal_number_or_a_string(written: str, value: object) -> None:
    assert parse_settings([f"numerics.dt_max={written}"]) == {"numerics.dt_max": value}
