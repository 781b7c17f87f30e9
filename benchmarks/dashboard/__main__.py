"""`python -m benchmarks.dashboard`: what the pages take (results/dashboard.md), what axe finds on them
(results/accessibility.md), their pictures (docs/pictures)."""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.dashboard import accessibility, pictures
from benchmarks.dashboard.browser import browsing, serving
from benchmarks.load.service import cpu_time
from service.cases import apply_settings, load_case, parse_case
from service.jobs import NewJob
from service.jobs.registry import insert_jobs
from service.settings import Settings
from validation.provenance import provenance
from worker.run import run_next

RESULTS = Path(__file__).parent.parent / "results"
JOBS, SCRUBS = 10_000, 60
FILM = {"numerics.intervals": 400, "output.interval": 34.0 / 499}
LONG = {"numerics.intervals": 1000, "output.interval": 0.1}

WORK = {"renderer": "the dashboard's own work", "gpu-process": "WebGL and the page drawn by software"}
"""The browser's processes by their kinds."""

SCRUB = """async (many) => {
  const slider = document.querySelector(".clock input"), end = Number(slider.max), waits = [];
  const frame = () => new Promise(done => requestAnimationFrame(done));
  const gl = document.querySelector(".stage").getContext("webgl2"), pixel = new Uint8Array(4);
  for (let k = 0; k < many; k += 1) {
    const began = performance.now();
    slider.value = String(end * ((k * 37) % many) / many);
    slider.oninput();
    await frame();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);  // waits until all is drawn
    waits.push(performance.now() - began);
  }
  return waits;
}"""
SHOWN = """() => new Promise(done => {
  const look = () => document.querySelector(".player:not([hidden])")
    ? requestAnimationFrame(() => requestAnimationFrame(() => done(performance.now()))) : requestAnimationFrame(look);
  look();
})"""


def main() -> None:
    """Measure, print and keep; look at each page with axe; take the pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], default=[], help="default all")
    for part in parser.parse_args().parts or PARTS:
        PARTS[part]()


def _times() -> None:
    with service() as (server, page, run):
        rows = [*_films(page, server.address, run), *_table(page, server.address, server.app.state.parts.registry)]
    load = f"{os.cpu_count()} cores, on which {os.getloadavg()[0]:.1f} processes wanted to run, WebGL by software"
    table = ["| what | measured | aim |", "|---|---:|---:|", *rows]
    _write(RESULTS / "dashboard.md", "What the dashboard takes", load, table)


def _accessibility() -> None:
    with service() as (server, page, run):
        with serving(server.app.state.parts.settings, keyed=True) as keyed:
            rows = accessibility.rows(page, keyed.address, {"/#login": "#login:not([hidden])"})
        rows += accessibility.rows(page, server.address, _pages(page, server.address, run))
    table = ["| page | rules that hold, in light | broken in light | in dark |", "|---|---:|---:|---:|", *rows]
    _write(RESULTS / "accessibility.md", "What axe finds on each page",
           f"axe-core {accessibility.version()}, on all pages", table)


def _pages(page: Any, address: str, run: Callable[..., str]) -> dict[str, str]:
    """Every page of dashboard and documentation, with what is on it when it is filled."""
    ids = [run("short-loop"), run("short-loop", t_end=1.0)]
    body = {"case": "elastica", "set": {"t_end": 0.5}, "parameters": {"loads.damping": [0.5, 1.0]}}
    ensemble = page.request.post(f"{address}/v1/ensembles", data=body).json()["id"]
    run("elastica", t_end=0.5)
    return {"/": "#jobs tbody tr", f"/#/jobs/{ids[0]}": "#page .chart",
            f"/#/compare?jobs={','.join(ids)}": "#page .chart",
            "/#/new?case=elastica": ".verdict .cost", "/#/ensembles": "#page tbody tr",
            f"/#/ensembles/{ensemble}": "#page circle", **dict.fromkeys(accessibility.documentation(), "main")}


def _write(path: Path, title: str, fact: str, table: list[str]) -> None:
    lines = [f"# {title}", "", *(f"- {line}" for line in (*provenance(), fact)), "", *table, ""]
    path.write_text("\n".join(lines), encoding="utf-8")
    print("\n".join(lines))


PARTS = {"times": _times, "accessibility": _accessibility, "pictures": pictures.take}


@contextmanager
def service() -> Iterator[tuple[Any, Any, Callable[..., str]]]:
    """The API without a worker, a page, and what runs a shipped case."""
    with tempfile.TemporaryDirectory() as data:
        settings = replace(Settings(data=Path(data)), rate=1e6, quota=2 * JOBS)
        with serving(settings) as server, browsing() as opened:
            registry = server.app.state.parts.registry

            def run(name: str, **values: Any) -> str:
                spec = parse_case(apply_settings(load_case(name), values))
                job = registry.submit(NewJob(spec.document(), title=spec.title))
                while run_next(registry.database, settings):
                    pass
                return str(job.id)

            yield server, opened(), run


def _films(page: Any, address: str, run: Callable[..., str]) -> list[str]:
    page.goto(f"{address}/#/jobs/{run('goyal-2003', **FILM)}")
    page.wait_for_selector(".player:not([hidden])")
    page.reload()
    ready = page.evaluate(SHOWN) / 1000
    frames = parse_case(apply_settings(load_case("goyal-2003"), FILM)).frames
    page.goto(f"{address}/#/jobs/{run('goyal-2003', **LONG)}")
    page.wait_for_selector(".player:not([hidden])")
    page.wait_for_selector("#page .chart")
    waits, cpu = _with_cpu(lambda: page.evaluate(SCRUB, SCRUBS))
    return [f"| {frames} frames of N = 400: from the request of the page to the picture | {ready:.2f} s | < 3 s |",
            f"| N = 1000, {SCRUBS} times scrubbed: a picture, median | {median(waits):.0f} ms | |",
            f"| the slowest of them | {max(waits):.0f} ms | no stall |",
            *(f"| CPU time a picture, {part} | {1000 * cpu[kind] / SCRUBS:.1f} ms | |" for kind, part in WORK.items())]


def _with_cpu(work: Callable[[], Any]) -> tuple[Any, dict[str, float]]:
    """What the work gives, and the CPU time (s) that it took each kind of the browser's processes."""
    before = {kind: cpu_time(f"--type={kind}") for kind in WORK}
    result = work()
    return result, {kind: cpu_time(f"--type={kind}") - spent for kind, spent in before.items()}


def _table(page: Any, address: str, registry: Any) -> list[str]:
    case = parse_case(load_case("elastica")).document()
    with registry.database.writing() as transaction:
        insert_jobs(transaction, [NewJob(case, title=f"rod {k}") for k in range(JOBS)])
    page.goto(address + "/")
    page.reload()
    page.wait_for_function("() => document.querySelectorAll('#jobs tbody tr').length === 50")
    rows = page.evaluate("performance.now()") / 1000
    first = page.wait_for_function("performance.getEntriesByName('first-contentful-paint')[0]?.startTime")
    painted = first.json_value() / 1000  # a busy browser tells of it after the rows are there
    return [f"| the table of {JOBS:,} jobs: first paint | {painted:.2f} s | < 1 s |",
            f"| its first 50 rows are there | {rows:.2f} s | |"]


if __name__ == "__main__":
    main()
