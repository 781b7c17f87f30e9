"""hockle demo: the paper's cable through the whole service, from a case over HTTP to its figures."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING, Any

from hockle.failure import Failure

if TYPE_CHECKING:
    from hockle.supervisor import Services
    from hockle_client import Client, Job

CASE = "goyal-2003"
LOOK = 0.3  # s


def register(subparsers: Any) -> None:
    """Add `hockle demo`."""
    parser = subparsers.add_parser("demo", help="the paper's cable, over HTTP, to figures")
    parser.add_argument("-o", "--output", type=Path, default=Path("demo"), help="directory (default ./demo)")
    parser.set_defaults(run=demo)


def demo(arguments: argparse.Namespace) -> int:
    """Serve, submit, wait, fetch, compare, draw, and stop everything again."""
    from hockle import plots
    from hockle.supervisor import Services, stop_on_signals
    from hockle_client import Client
    from service.settings import Settings

    stop_on_signals()
    arguments.output.mkdir(parents=True, exist_ok=True)
    path = arguments.output / f"{CASE}.nc"
    print("starting API, worker and broker", flush=True)
    with tempfile.TemporaryDirectory(prefix="hockle-demo-") as data:
        with Services(Settings(data=Path(data)), port=0) as services, Client(services.address) as client:
            print(f"serving at {services.address}", flush=True)
            _run(services, client, path)
        print("API, worker and broker are stopped", flush=True)
    print(plots.milestones_table(path))
    for figure in plots.draw(path, arguments.output):
        print(figure)
    return 0


def _run(services: Services, client: Client, path: Path) -> None:
    from hockle.progress import show

    job = client.submit(CASE, again=True)
    print(f"submitted {CASE}: {services.address}/v1/jobs/{job.id}", flush=True)
    print("(the very first run compiles the solver before it starts, which takes about a minute)", flush=True)
    show(_looked_after(services, job))
    if job.status != "successful":
        raise Failure(f"the job ended {job.status}: {job.message}")
    size = job.fetch(path)
    print(f"fetched {path} ({size / 1e6:.1f} MB)", flush=True)


def _looked_after(services: Services, job: Job) -> Iterator[dict[str, Any]]:
    while not job.ended:
        sleep(LOOK)
        services.look_after()
        yield job.refresh().state.model_dump()
