"""The pictures of the dashboard that the documents show."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image

from service.cases import apply_settings, load_case, parse_case
from service.jobs import NewJob
from worker.run import run_next

PLACE = Path(__file__).parent.parent.parent / "docs" / "pictures"
PAPERS_TIMES = (20.0, 25.0, 29.0, 32.0)
COLOURS = 128
"""Of a picture that is kept: enough, and a third of the room."""

WORKER = """
import sys
from pathlib import Path
from service.jobs import Database
from service.settings import Settings
from worker.run import run_next
settings = Settings(data=Path(sys.argv[1]))
run_next(Database(settings.database_url), settings)
"""
SCRUB = "t => { const slider = document.querySelector('.clock input'); slider.value = String(t); slider.oninput(); }"
DRAWN = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


def take(page: Any, address: str, run: Callable[..., str], registry: Any, settings: Any) -> None:
    """Take all of them, on a service of which `run` runs shipped cases."""
    ids = [run("goyal-2003"), run("goyal-2003", **{"fluid.drag_normal": 1.0}), run("short-loop"), run("hanging-cable")]

    def open_(path: str, ready: str) -> None:
        page.goto(f"{address}/#/{path}")
        page.wait_for_selector(ready, state="attached")
        page.evaluate(DRAWN)

    open_(f"jobs/{ids[0]}", ".player:not([hidden])")
    _paper(page)
    page.select_option("[name=colour]", "curvature")
    page.evaluate(SCRUB, 31.0)
    _keep(page, "dashboard-job")
    open_(f"compare?jobs={ids[0]},{ids[1]}", ".player:not([hidden])")
    _keep(page, "dashboard-compare")
    _running(page, open_, registry, settings)
    _ensemble(page, address, open_, registry, settings)
    open_("new?case=elastica", ".verdict .cost")
    page.fill("#case-rod-length", "-1")
    page.wait_for_selector("#case-rod-length-told .fault")
    _keep(page, "dashboard-refused")
    open_("", "#jobs tbody tr")
    _keep(page, "dashboard-jobs")
    page.emulate_media(color_scheme="dark")
    open_(f"jobs/{ids[3]}", ".player:not([hidden])")
    _keep(page, "dashboard-dark")
    page.emulate_media(color_scheme="light")
    page.set_viewport_size({"width": 390, "height": 800})
    open_(f"jobs/{ids[2]}", ".player:not([hidden])")
    _keep(page, "dashboard-phone")
    page.set_viewport_size({"width": 1200, "height": 800})


def _running(page: Any, open_: Callable[[str, str], None], registry: Any, settings: Any) -> None:
    """A run that goes on, as soon as it shows frames; then it is cancelled."""
    spec = parse_case(apply_settings(load_case("goyal-2003"), {"numerics.intervals": 1500, "numerics.dt_max": 0.01}))
    job = registry.submit(NewJob(spec.document(), title=spec.title))
    worker = subprocess.Popen([sys.executable, "-c", WORKER, str(settings.data)])
    open_(f"jobs/{job.id}", "#page .chart")
    page.wait_for_selector(".player:not([hidden])")
    _keep(page, "dashboard-running")
    registry.cancel(job.id)
    worker.wait()


def _ensemble(page: Any, address: str, open_: Callable[[str, str], None], registry: Any, settings: Any) -> None:
    body = {"case": "cantilever-vibration", "title": "a cantilever's stiffness and damping",
            "set": {"t_end": 4, "numerics.intervals": 20}, "sample": {"method": "sobol", "size": 32, "seed": 3},
            "parameters": {"stiffness": {"path": "rod.youngs_modulus", "low": 5e6, "high": 5e7, "scale": "log"},
                           "damping": {"path": "loads.damping", "low": 0.0, "high": 2.0}}}  # fmt: skip
    answer = page.request.post(f"{address}/v1/ensembles", data=body)
    while run_next(registry.database, settings):
        pass
    open_(f"ensembles/{answer.json()['id']}", "#page circle")
    _keep(page, "dashboard-ensemble")


def _paper(page: Any) -> None:
    """The cable at the four times of the paper's figure 6, in one picture."""
    parts = []
    for t in PAPERS_TIMES:
        page.evaluate(SCRUB, t)
        page.evaluate(DRAWN)
        parts.append(Image.open(BytesIO(page.locator(".stage").screenshot())).convert("RGB"))
    wide, tall = parts[0].size
    whole = Image.new("RGB", (2 * wide, 2 * tall))
    for k, part in enumerate(parts):
        whole.paste(part, (wide * (k % 2), tall * (k // 2)))
    _save(whole.resize((wide, tall)), "dashboard-figure-6")


def _keep(page: Any, name: str) -> None:
    page.evaluate(DRAWN)
    page.wait_for_timeout(300)
    _save(Image.open(BytesIO(page.screenshot())).convert("RGB"), name)


def _save(picture: Image.Image, name: str) -> None:
    picture.quantize(COLOURS).save(PLACE / f"{name}.png", optimize=True)
