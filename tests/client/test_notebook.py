"""docs/sweep.ipynb is short, and kept without its outputs; tests/docs runs it."""

from __future__ import annotations

import json
from pathlib import Path

NOTEBOOK = json.loads((Path(__file__).parents[2] / "docs" / "sweep.ipynb").read_text())
CELLS = ["".join(cell["source"]) for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]


def test_the_sweep_of_200_takes_at_most_eight_lines():
    [first] = [cell for cell in CELLS if "linspace" in cell]
    assert len([line for line in first.splitlines() if line.strip()]) <= 8 and "200)" in first
    assert all(cell["outputs"] == [] for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code")
