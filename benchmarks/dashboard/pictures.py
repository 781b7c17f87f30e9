"""The pictures of the dashboard that the documents show."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image

from benchmarks.dashboard.browser import browsing
from benchmarks.load.service import with_workers
from hockle_client import Client

PLACE = Path(__file__).parent.parent.parent / "docs" / "pictures"
PAPERS_TIMES = (20.0, 25.0, 29.0, 32.0)
COLOURS = 128
"""Of a picture that is kept: enough, and a third of the room."""

SCRUB = "t => { const slider = document.querySelector('.clock input'); slider.value = String(t); slider.oninput(); }"
DRAWN = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


def take() -> None:
    """Take all of them, on `hockle serve` with a worker."""
    with with_workers() as (host, port, _), browsing() as opened:
        _take(opened(), Service(f"http://{host}:{port}"))


class Service:
    """Runs cases, and waits for them."""

    def __init__(self, address: str) -> None:
        """Of the service at that address."""
        self.address = address
        self.client = Client(address)

    def run(self, name: str, **settings: Any) -> str:
        """The id of a run of a shipped case with these settings, which has ended."""
        return str(self.client.submit(name, set=settings).wait().id)


def _take(page: Any, service: Service) -> None:
    ids = [service.run("goyal-2003"), service.run("goyal-2003", **{"fluid.drag_normal": 1.0}),
           service.run("short-loop"), service.run("hanging-cable")]  # fmt: skip

    def open_(path: str, ready: str) -> None:
        page.goto(f"{service.address}/#/{path}")
        page.wait_for_selector(ready, state="attached")
        page.wait_for_selector("#health.ok")
        page.evaluate(DRAWN)

    open_(f"jobs/{ids[0]}", ".player:not([hidden])")
    _paper(page)
    page.select_option("[name=colour]", "curvature")
    page.evaluate(SCRUB, 31.0)
    _keep(page, "dashboard-job")
    open_(f"compare?jobs={ids[0]},{ids[1]}", ".player:not([hidden])")
    _keep(page, "dashboard-compare")
    _running(page, open_, service)
    open_("", "#jobs tbody tr")
    _keep(page, "dashboard-jobs")
    _ensemble(page, open_, service)
    open_("new?case=elastica", ".verdict .cost")
    page.fill("#case-rod-length", "-1")
    page.wait_for_selector("#case-rod-length-told .fault")
    _keep(page, "dashboard-refused")
    page.emulate_media(color_scheme="dark")
    open_(f"jobs/{ids[3]}", ".player:not([hidden])")
    _keep(page, "dashboard-dark")
    page.emulate_media(color_scheme="light")
    page.set_viewport_size({"width": 390, "height": 800})
    open_(f"jobs/{ids[2]}", ".player:not([hidden])")
    _keep(page, "dashboard-phone")


def _running(page: Any, open_: Callable[[str, str], None], service: Service) -> None:
    """A run that goes on, as soon as it shows frames; then it is cancelled."""
    job = service.client.submit("goyal-2003", set={"numerics.intervals": 1500, "numerics.dt_max": 0.01})
    open_(f"jobs/{job.id}", "#page .chart")
    page.wait_for_selector(".player:not([hidden])")
    _keep(page, "dashboard-running")
    job.cancel()
    job.wait()


def _ensemble(page: Any, open_: Callable[[str, str], None], service: Service) -> None:
    body = {"case": "cantilever-vibration", "title": "a cantilever's stiffness and damping",
            "set": {"t_end": 4, "numerics.intervals": 20}, "sample": {"method": "sobol", "size": 32, "seed": 3},
            "parameters": {"stiffness": {"path": "rod.youngs_modulus", "low": 5e6, "high": 5e7, "scale": "log"},
                           "damping": {"path": "loads.damping", "low": 0.0, "high": 2.0}}}  # fmt: skip
    ensemble_id = page.request.post(f"{service.address}/v1/ensembles", data=body).json()["id"]
    open_(f"ensembles/{ensemble_id}", "#page figure")
    page.wait_for_selector("#page > div > .status.successful", timeout=300_000)
    _keep(page, "dashboard-ensemble")


def _paper(page: Any) -> None:
    """The cable at the four times of the paper's figure 6, in one picture."""
    parts = []
    for t in PAPERS_TIMES:
        page.evaluate(SCRUB, t)
        page.evaluate(DRAWN)
        parts.append(Image.open(BytesIO(page.locator(".stage").screenshot())).convert("RGB"))
    wide, tall = parts[0].size
    sheet = Image.new("RGB", (2 * wide, 2 * tall))
    for k, part in enumerate(parts):
        sheet.paste(part, (wide * (k % 2), tall * (k // 2)))
    _save(sheet.resize((wide, tall)), "dashboard-figure-6")


def _keep(page: Any, name: str) -> None:
    page.evaluate(DRAWN)
    page.wait_for_timeout(300)
    _save(Image.open(BytesIO(page.screenshot())).convert("RGB"), name)


def _save(picture: Image.Image, name: str) -> None:
    few = picture.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(PLACE / f"{name}.png", optimize=True)
