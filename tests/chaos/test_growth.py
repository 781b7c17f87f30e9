"""What grows is told, processes and disk alike."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from chaos.growth import Growth


@pytest.mark.parametrize(("sizes", "flat"), [([1.0, 5.0, 5.0, 5.4], True), ([1.0, 5.0, 5.0, 5.6], False)])
def test_a_disk_that_grows_is_told(sizes, flat):
    growth = Growth(SimpleNamespace(), {("worker", 1): [(300.0, 9, 1)] * 4}, sizes)
    assert growth.flat is flat
    assert growth.lines()[-1] == f"| disk | 4 | 5.0 | {sizes[-1]:.1f} |  |  | {'flat' if flat else 'GROWS'} |"
