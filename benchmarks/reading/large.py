"""A dataset of 2 GB: published, read whole, and in parts; the time, and what server and client hold of it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from pathlib import Path

import httpx
import numpy as np

from benchmarks.reading.memory import peak_of, started_here
from service.cases import CaseSpec, build_scene, parse_case
from service.jobs import Database
from service.jobs.held import claim
from service.jobs.job import Dataset, Reached
from service.jobs.lifecycle import Status
from service.results import DatasetWriter
from service.results.schema import LABELS, Variable, stored_variables
from service.results.segments import Block, Segment, write_segment
from service.settings import Settings
from solver import simulate

BYTES, INTERVALS, IN_BLOCK = 2.0e9, 400, 200
LEAST = 0.05
"""Part of the file that none of the processes shall hold."""
CASE = {"numerics.intervals": INTERVALS, "numerics.dt_max": 0.02, "t_end": 5.0, "output.interval": 0.01}
READS = {
    "whole, into a file (fetch)": "job.fetch(path)",
    "whole, opened and one frame looked at (dataset)": "job.dataset().r[-1].load()",
    "r of 10 frames by /data (data)": "job.data('r', t_min=0.4995, t_max=0.5085)",
    "Tw of all frames by /data (data)": "job.data('Tw')",
    "r of one frame by Zarr": "xr.open_zarr(link.zarr).r[-1].load()",
    "r of one frame by OPeNDAP": "xr.open_dataset(client.url + job.state.links['opendap']).r[-1].load()",
    "r of one frame by bytes of a link": "xr.open_dataset(link.url + '#mode=bytes').r[-1].load()",
}
CLIENT = """
import json, re, sys, time, warnings
warnings.simplefilter("ignore")
import netCDF4, numpy, xarray as xr, zarr
from hockle_client import Client
url, job, path, read = sys.argv[1:]
client = Client(url)
job = client.job(job)
link = job.link()
peak = lambda: int(re.search(r"VmHWM:\\s+(\\d+) kB", open("/proc/self/status").read())[1])
before, began = peak(), time.perf_counter()
eval(read)
print(json.dumps([time.perf_counter() - began, (peak() - before) / 1e3]))
"""


@dataclass(frozen=True)
class Cost:
    """What something took (s), and the most memory (MB) that it added to the server and to its client."""

    label: str
    seconds: float
    server: float | None
    client: float


def of_a_large_dataset(address: str, settings: Settings) -> tuple[float, list[Cost]]:
    """The size (bytes) of the file, and what publishing and reading it took."""
    with httpx.Client(base_url=address, timeout=600.0) as client:
        job = client.post("/v1/jobs", json={"case": "cantilever-vibration", "set": CASE}).raise_for_status().json()
        case = client.get(job["links"]["case"]).raise_for_status().json()
    job_id = str(job["id"])
    path, published = _published(job_id, parse_case(case), settings)
    servers = started_here("api")
    return path.stat().st_size, [published, *(_read(address, job_id, label, servers) for label in READS)]


def _read(address: str, job_id: str, label: str, servers: list[int]) -> Cost:
    figures: list[float] = []
    with tempfile.TemporaryDirectory() as directory:
        command = [sys.executable, "-c", CLIENT, address, job_id, f"{directory}/run.nc", READS[label]]
        server = peak_of(servers, lambda: figures.extend(json.loads(subprocess.check_output(command))))
    return Cost(label, figures[0], server, figures[1])


def _published(job_id: str, spec: CaseSpec, settings: Settings) -> tuple[Path, Cost]:
    """The job ended, with a dataset of chance numbers, which cannot be packed; as a worker does it."""
    path, took, published = settings.datasets / f"{job_id}.1.nc", [0.0], []
    with tempfile.TemporaryDirectory(dir=settings.data) as directory:
        segments = list(_segments(Path(directory), stored_variables(spec)))

        def publish() -> None:
            began = time.perf_counter()
            with DatasetWriter(path, spec, Path(directory), segments) as writer:
                published.append(writer.publish("completed", "", simulate(build_scene(spec))))
            took[0] = time.perf_counter() - began

        grown = peak_of([os.getpid()], publish)
    _end(job_id, Dataset(path.name, published[0].sha256, published[0].bytes), settings)
    return path, Cost("put together, verified and published, from its segments", took[0], None, grown)


def _end(job_id: str, dataset: Dataset, settings: Settings) -> None:
    database = Database(settings.database_url)
    held = claim(database, job_id, 60.0, "benchmark:0")
    if held is None or held.finish(Status.SUCCESSFUL, "completed", "", dataset, Reached(1.0, 5.0)) is None:
        raise RuntimeError(f"job {job_id} cannot be ended")
    database.close()


def _segments(directory: Path, variables: tuple[Variable, ...]) -> Iterator[Segment]:
    rng = np.random.default_rng(1)
    sizes = {"s": INTERVALS + 1, **{name: len(labels) for name, labels in LABELS.items()}}
    shapes = {variable.name: tuple(sizes[name] for name in variable.dimensions[1:]) for variable in variables}
    frame = sum(8 * prod(shape) for shape in shapes.values())
    for first in range(0, int(BYTES / frame) + 1, IN_BLOCK):
        block: Block = {variable.name: _chance(rng, variable, shapes[variable.name]) for variable in variables}
        block["time"] = 1e-3 * np.arange(first, first + IN_BLOCK)
        yield write_segment(directory, first, "benchmark", block)


def _chance(rng: np.random.Generator, variable: Variable, shape: tuple[int, ...]) -> np.ndarray:
    if variable.type == "i4":
        return rng.integers(0, 2**31, (IN_BLOCK, *shape), dtype=np.int32)
    return rng.standard_normal((IN_BLOCK, *shape)) * np.exp2(rng.integers(-500, 500, (IN_BLOCK, *shape)))


def lines(size: float, rows: list[Cost]) -> list[str]:
    """The table in Markdown."""
    aim = f"<= {LEAST * size / 1e6:.0f}"
    head = [f"A dataset of {size / 1e9:.2f} GB: chance numbers, {INTERVALS + 1} nodes, written as a worker does. MB is",
            "the most by which resident memory grew meanwhile, of one API process, and of the process that reads (or",
            "publishes).", "", "| what | s | MB of the server | MB of the client | aim, MB |", "|---|---|---|---|---|"]
    return ["", *head, *(f"| {row.label} | {row.seconds:.2f} | {'' if row.server is None else f'{row.server:.0f}'} | "
                         f"{row.client:.0f} | {aim} |" for row in rows)]  # fmt: skip
