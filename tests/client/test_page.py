"""What docs/client.md shows is short; tests/docs runs it."""

from __future__ import annotations

import re
from pathlib import Path

PAGE = (Path(__file__).parents[2] / "docs" / "client.md").read_text()
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)


def test_a_sweep_of_200_takes_at_most_eight_lines():
    [sweep] = [block for block in BLOCKS if "linspace" in block]
    assert "sweep.dataset(" in sweep and "sweep.table(" in sweep
    assert len([line for line in sweep.splitlines() if line.strip()]) <= 8
    assert "200)" in sweep
