"""`python -m benchmarks.work_precision [scene ...]`: measure the scenes named, or all; tables and figure of all."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

SINGLE = dict.fromkeys(("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
os.environ.update(SINGLE)  # before numpy, which reads them when it is imported

from benchmarks.work_precision import figure, table  # noqa: E402
from benchmarks.work_precision.measure import LONGEST, Point  # noqa: E402
from benchmarks.work_precision.processes import SCENES, measure  # noqa: E402
from validation.provenance import provenance  # noqa: E402

RESULTS = Path(__file__).parent.parent / "results"
STEM = "work_precision"


def main(names: list[str]) -> None:
    """Measure scene by scene and keep each; those that were not asked for stay as they were last measured."""
    file = RESULTS / f"{STEM}.json"
    if not names:
        file.unlink(missing_ok=True)
    kept: dict[str, Any] = {}
    for scene, points in measure(names or list(SCENES)):
        kept = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
        kept[scene] = {"made with": made_with(), "points": [asdict(p) for p in points]}
        file.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    text = "\n".join(report(kept))
    print(text)
    (RESULTS / f"{STEM}.md").write_text(text, encoding="utf-8")
    figure.draw(points_of(kept), RESULTS / f"{STEM}.png")


def made_with() -> list[str]:
    """Commit, CPU and versions."""
    return [*provenance(), f"PyElastica {version('pyelastica')}, MuJoCo {version('mujoco')}"]


def points_of(kept: dict[str, Any]) -> list[Point]:
    """All points, in the order of the scenes."""
    return [Point(**point) for scene in SCENES if scene in kept for point in kept[scene]["points"]]


def report(kept: dict[str, Any]) -> list[str]:
    """The lines of the tables, and of what they were made with."""
    points = points_of(kept)
    text = ["# Work against error", "",
            "Process CPU time of one thread, compiling apart; the cheapest of three where a run takes under 2 s. A "
            f"peer's run that would take over {LONGEST:g} CPU s is not made.", ""]  # fmt: skip
    text += table.summary(points) + table.at_equal_error(points) + table.agreement(points)
    text += ["## What is solved, and what it was measured with", ""]
    for name in (name for name in SCENES if name in kept):
        description = " ".join((SCENES[name].__doc__ or "").split())
        text += [f"**{SCENES[name].SCENE}.** {description} *{'; '.join(kept[name]['made with'])}.*", ""]
    return text + table.results(points)


if __name__ == "__main__":
    main(sys.argv[1:])
