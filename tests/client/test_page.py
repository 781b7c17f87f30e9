"""What docs/client.md shows has types, and is short; tests/docs runs it."""

from __future__ import annotations

import re
from pathlib import Path

from mypy import api

PAGE = (Path(__file__).parents[2] / "docs" / "client.md").read_text()
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)


def test_a_type_checker_finds_no_fault_with_it(tmp_path, monkeypatch):
    monkeypatch.setenv("MYPYPATH", str(Path(__file__).parents[2] / "client"))
    (tmp_path / "page.py").write_text("".join(BLOCKS))
    told = ["--strict", "--python-version", "3.11", "--follow-imports", "silent", "--ignore-missing-imports"]
    out, _, status = api.run([*told, "--cache-dir", str(tmp_path), str(tmp_path / "page.py")])
    assert status == 0, out


def test_a_sweep_of_200_takes_at_most_eight_lines():
    [sweep] = [block for block in BLOCKS if "linspace" in block]
    assert "sweep.dataset(" in sweep and "sweep.table(" in sweep
    assert len([line for line in sweep.splitlines() if line.strip()]) <= 8
    assert "200)" in sweep
