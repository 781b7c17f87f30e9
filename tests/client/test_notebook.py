"""docs/sweep.ipynb runs, cell by cell; only with fewer and shorter cases."""

from __future__ import annotations

import json
from pathlib import Path

import matplotlib as mpl

NOTEBOOK = json.loads((Path(__file__).parents[2] / "docs" / "sweep.ipynb").read_text())
CELLS = ["".join(cell["source"]) for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]
SHORTER = {"200)": "4)", '"t_end", 30.0)': '"t_end", 0.3).set("output.interval", 0.1)', '"t_end": 35.0': '"t_end": 0.4',
           '"numerics.intervals", 100': '"numerics.intervals", 20'}  # fmt: skip


def test_every_cell_runs_in_its_order(server, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    mpl.use("agg")
    names: dict = {}
    whole = "\n".join(CELLS)
    for long, short in {**SHORTER, "http://127.0.0.1:8000": server.address}.items():
        assert long in whole
        whole = whole.replace(long, short)
    exec(compile(whole, "sweep.ipynb", "exec"), names)
    assert len(names["table"]) == 4 and names["whole"].Wr.dims == ("loads.damping", "time")
    assert (tmp_path / "cable.glb").read_bytes()[:4] == b"glTF"
    assert "successful" in capsys.readouterr().out


def test_the_sweep_of_200_takes_at_most_eight_lines():
    [first] = [cell for cell in CELLS if "linspace" in cell]
    assert len([line for line in first.splitlines() if line.strip()]) <= 8 and "200)" in first
    assert all(cell["outputs"] == [] for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code")
