"""What pages say of the results of their blocks, beside the answers that they show."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
import pytest

from solver import Initial, Numerics, Scene, simulate
from solver.methods.linear.system import LinearSolver
from tests.docs.page import Page
from tests.solver.methods.problem import problem
from tests.solver.methods.test_box_linear import banded_error, eliminate
from tests.solver.scenes import ROD


def readme(page: Page) -> None:
    """The tips of its two rods; a picture, a film, and the file that curl got."""
    [tip] = re.findall(r"^-0\.\d{4,}$", page.printed, re.M)
    assert float(tip) == pytest.approx(-0.09733, abs=2e-5)
    [*_, last] = re.findall(r"e1 = (-\d\.\d+) m", page.printed)
    assert float(last) == pytest.approx(-0.27610, abs=1e-4)  # it still swings by 1.5e-5
    files = {path.name for path in page.folder.iterdir()}
    assert {"sagging-rod.mp4", "sagging-rod-snapshots.png"} <= files
    assert {f"{one}.nc" for one in page.ids.values()} & files


def first_ten_minutes(page: Page) -> None:
    """How the run ended, and its pictures."""
    assert "completed\n[" in page.printed
    assert (page.folder / "cantilever-vibration-snapshots.png").exists()


def tutorial(page: Page) -> None:
    """How the three jobs ended; a picture and a film."""
    assert page.printed.splitlines()[-3:] == ["successful completed"] * 3
    assert (page.folder / "hose-topology.png").exists()
    assert (page.folder / "hose.gif").read_bytes().startswith(b"GIF8")


def accuracy(page: Page) -> None:
    """The tolerance was met."""
    [(met, error)] = re.findall(r"^(yes|no) (\d\S+)$", page.printed, re.M)
    assert met == "yes" and 0.0 < float(error) < 1e-2


def client(page: Page) -> None:
    """What its blocks print and leave."""
    assert page.printed.startswith("successful completed ")
    assert "422 invalid_case" in page.printed and "'/set/rod.length'" not in page.printed
    assert (page.folder / "run.nc").read_bytes()[:4] == b"\x89HDF"
    names = page.names
    assert sorted(names["part"].data_vars) == ["Wr", "r"] and list(names["table"]) == ["Tw", "Wr", "Lk"]
    assert names["whole"].sizes["member"] == 4 and "loads.damping" in names["whole"].coords


def notebook(page: Page) -> None:
    """Its table, its curves and the moving rod."""
    assert len(page.names["table"]) == 4 and page.names["whole"].Wr.dims == ("loads.damping", "time")
    assert (page.folder / "cable.glb").read_bytes()[:4] == b"glTF"
    assert "successful" in page.printed


def extending(page: Page) -> None:
    """A load, two ends and a linear solver of a reader's own."""
    heights = [float(height) for height in re.findall(r"height ([+-]\d\.\d+) m", page.printed)]
    assert len(heights) == 11
    # it falls through the plane, is caught where springs and weight are as large, and thrown back
    assert heights[0] == 0.05
    assert min(heights) < -0.02
    assert heights[heights.index(min(heights)) + 1] > min(heights)
    for method in ("box", "staggered"):
        hinge_and_winch(page, method)
    dense: LinearSolver = page.names["Dense"].empty(20)
    case = problem(20, damping=0.5)
    assert banded_error(case, eliminate(case, dense)) <= 1e-14


def hinge_and_winch(page: Page, method: str) -> None:
    """A rod that turns freely about one axis at its start, and whose end is drawn."""
    bent = Initial(lambda s: np.stack([np.sin(s), np.zeros_like(s), 1.0 - np.cos(s)], axis=1), a1=(0.0, 1.0, 0.0))
    hinge, winch = page.names["hinge"](0), page.names["winch"](0.02, 0.5)
    numerics = Numerics(method=method, intervals=16, dt_max=0.02)
    first, last = simulate(Scene(ROD, bent, hinge, winch, 0.6, 0.6, numerics=numerics, damping=5.0))
    assert last.r[-1] - first.r[-1] == pytest.approx([0.02, 0.0, 0.0], abs=2e-5)
    assert np.abs(last.q[0, 0]) < 1e-8  # it may turn about a1
    assert np.abs(last.omega[0, 1:]).max() < 1e-12


CLAIMS: dict[str, Callable[[Page], None]] = {
    "README.md": readme, "docs/first-ten-minutes.md": first_ten_minutes, "docs/tutorial.md": tutorial,
    "docs/accuracy.md": accuracy, "docs/client.md": client, "docs/extending.md": extending,
    "docs/sweep.ipynb": notebook,
}  # fmt: skip
