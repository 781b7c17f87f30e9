"""What docs/client.md shows is so; only with fewer and shorter runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from mypy import api

PAGE = (Path(__file__).parents[2] / "docs" / "client.md").read_text()
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)
SHORTER = {"fork(5.0": "fork(0.15", "30.0": "0.3", "40.0": "0.4", "(10.0, 20.0)": "(0.1, 0.2)",
           "t_min=10.0": "t_min=0.1", "200)": "4)",
           '"numerics.intervals", 100': '"numerics.intervals", 20).set("output.interval", 0.1',
           'label="sweep").wait': 'label="sweep", set={"t_end": 0.3}).wait',
           "size=8, seed=1": 'size=2, seed=1, set={"t_end": 0.3}'}  # fmt: skip


@pytest.mark.filterwarnings("error::FutureWarning")
def test_every_block_runs_in_its_order(server, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    told = "".join(BLOCKS)
    for long, short in SHORTER.items():
        assert long in told
        told = told.replace(long, short)
    names: dict = {}
    exec(compile(told.replace("http://127.0.0.1:8000", server.address), "client.md", "exec"), names)
    printed = capsys.readouterr().out
    assert printed.startswith("successful completed ")
    assert "422 invalid_case" in printed and "'/set/rod.length'" not in printed
    assert (tmp_path / "run.nc").read_bytes()[:4] == b"\x89HDF"
    assert sorted(names["part"].data_vars) == ["Wr", "r"] and list(names["table"]) == ["Tw", "Wr", "Lk"]
    assert names["whole"].sizes["member"] == 4 and "loads.damping" in names["whole"].coords


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
    assert SHORTER["200)"] == "4)"
