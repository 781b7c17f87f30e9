"""What docs/extending.md shows is so."""

from __future__ import annotations

import re
from importlib import util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from solver import Initial, Numerics, Scene, simulate
from solver.methods.linear.system import LinearSolver
from tests.solver.methods.problem import problem
from tests.solver.methods.test_box_linear import banded_error, eliminate
from tests.solver.scenes import ROD

ROOT = Path(__file__).parent.parent
PAGE = (ROOT / "docs" / "extending.md").read_text()


def block(containing: str) -> str:
    """The block of code that holds some text."""
    [found] = [code for code in re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S) if containing in code]
    return str(found)


def module_of(code: str, folder: Path) -> ModuleType:
    """A module of its own, as a reader would write it: numba's cache wants a file."""
    file = folder / "mine.py"
    file.write_text(code)
    spec = util.spec_from_file_location("mine", file)
    assert spec and spec.loader
    module = util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_load_in_python_acts_and_its_energy_is_in_the_books(tmp_path, capsys):
    module_of(block("class Mattress"), tmp_path)
    heights = [float(h) for h in re.findall(r"height ([+-]\d\.\d+) m", capsys.readouterr().out)]
    assert len(heights) == 11
    # it falls through the plane, is caught where springs and weight are as large, and thrown back
    assert heights[0] == 0.05
    assert min(heights) < -0.02
    assert heights[heights.index(min(heights)) + 1] > min(heights)


@pytest.mark.parametrize("method", ["box", "staggered"])
def test_end_conditions_are_functions_that_give_ends(method, tmp_path):
    module = module_of("from solver import End\n" + block("def hinge"), tmp_path)
    numerics = Numerics(method=method, intervals=16, dt_max=0.02)
    bent = Initial(lambda s: np.stack([np.sin(s), np.zeros_like(s), 1.0 - np.cos(s)], axis=1), a1=(0.0, 1.0, 0.0))
    scene = Scene(ROD, bent, module.hinge(0), module.winch(0.02, 0.5), 0.6, 0.6, numerics=numerics, damping=5.0)
    first, last = simulate(scene)
    assert last.r[-1] - first.r[-1] == pytest.approx([0.02, 0.0, 0.0], abs=2e-5)
    assert np.abs(last.q[0, 0]) < 1e-8  # it may turn about a1
    assert np.abs(last.omega[0, 1:]).max() < 1e-12


def test_an_output_is_one_entry():
    shown = " ".join(block("max_curvature").split())
    assert shown in " ".join((ROOT / "solver/measures/frame.py").read_text().split())


def test_a_linear_solver_is_a_record_and_two_kernels(tmp_path):
    module, case = module_of(block("class Dense"), tmp_path), problem(20, damping=0.5)
    dense: LinearSolver = module.Dense.empty(20)
    assert banded_error(case, eliminate(case, dense)) <= 1e-14
