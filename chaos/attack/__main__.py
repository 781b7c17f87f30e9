"""`make attack`: a bounded campaign against a service on loopback; prints and keeps a table, 1 if anything gave way."""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path

import httpx

from chaos.attack.crowd import slowloris
from chaos.attack.parsers import patient_parsers
from chaos.attack.processes import disturbed
from chaos.attack.requests import odd_requests
from chaos.attack.table import Row, keep, text
from chaos.campaign import free_port
from chaos.served import Served
from hockle.supervisor import ENVIRONMENT, stop_on_signals
from service.cases import apply_settings, load_case
from service.settings import Settings
from validation.provenance import provenance

SMALL = {"t_end": 0.05, "output.interval": 0.01, "numerics.intervals": 8}


def main() -> int:
    """Attack, and tell what was seen."""
    parser = argparse.ArgumentParser(prog="python -m chaos.attack", description=__doc__)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6), help="of all at random")
    parser.add_argument("--jobs", type=int, default=500, help="while so many run, processes are killed and stopped")
    parser.add_argument("--slow", type=int, default=2000, help="slow connections")
    parser.add_argument("--clients", type=int, default=200, help="honest clients beside them")
    parser.add_argument("--seconds", type=float, default=400.0, help="of CPU for which each parser is tried")
    parser.add_argument("--minutes", type=float, default=180.0, help="for jobs and parsers at the most")
    arguments = parser.parse_args()
    stop_on_signals()  # and clean up then
    os.environ |= ENVIRONMENT
    command = f"seed {arguments.seed}: `python -m chaos.attack " + " ".join(
        f"--{name} {value:g}" for name, value in vars(arguments).items()) + "`"  # fmt: skip
    print(command, flush=True)
    made_with = [*provenance(), command]
    rows: list[Row] = []
    with serving() as (port, job_id):
        rows += slowloris(port, job_id, arguments.slow, arguments.clients, 30.0)
        rows += odd_requests(port)
    with ProcessPoolExecutor(1, get_context("spawn")) as beside:
        tried = beside.submit(patient_parsers, arguments.seed, arguments.seconds, arguments.minutes)
        rows += disturbed(arguments.seed, arguments.jobs, arguments.minutes)
        rows += tried.result()
    print(text(made_with, rows))
    keep(made_with, rows)
    return 0 if all(row.good for row in rows) else 1


@contextmanager
def serving() -> Iterator[tuple[int, str]]:
    """The port of a service, and a job of its own."""
    with tempfile.TemporaryDirectory(prefix="hockle-attack-", ignore_cleanup_errors=True) as directory:
        port, settings = free_port(), Settings(data=Path(directory) / "data")
        settings.make_directories()
        served = Served(settings, port)
        served.clock.write_text("0")
        served.start()
        try:
            case = apply_settings(load_case("cantilever-vibration"), SMALL)
            answer = httpx.post(f"{served.address}/v1/jobs", json=case, timeout=60.0, trust_env=False,
                                headers={"Prefer": "wait=60"})  # fmt: skip
            yield port, answer.raise_for_status().json()["id"]
        finally:
            served.stop()


if __name__ == "__main__":
    sys.exit(main())
