"""What is read of a dataset and of many jobs, each as often as said, and how long each took."""

from __future__ import annotations

import os
import secrets
import subprocess
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import fmean
from typing import Any

import httpx
import numpy as np

from benchmarks.load.service import cpu_time
from benchmarks.load.table import Row
from service.jobs import Database, NewJob
from service.jobs.registry import insert_jobs
from service.settings import Settings

LARGE = {"numerics.intervals": 400, "numerics.dt_max": 0.02, "t_end": 5.0, "output.interval": 0.01}
"""500 frames of 401 nodes, with all fields."""
MEMBER = {"numerics.intervals": 100, "t_end": 1.0, "output.interval": 0.1}
TIMES, LISTED, AT_ONCE, MEMBERS = 100, 10_000, 500, 1000


def measured(what: str, times: int, ask: Callable[[], Any], aim: str = "") -> Row:
    """How long each of so many calls took, after one that is not counted, and the CPU time of the service for each."""
    ask()
    seconds, cpu = [], cpu_time()
    for _ in range(times):
        began = time.perf_counter()
        ask()
        seconds.append(time.perf_counter() - began)
    return Row(what, seconds, aim, cpu=(cpu_time() - cpu) / times)


def finished(client: httpx.Client, body: dict[str, Any]) -> str:
    """The id of a job that has run it."""
    job = client.post("/v1/jobs", json=body).raise_for_status().json()
    while job["status"] in ("accepted", "running"):
        time.sleep(0.2)
        job = client.get(f"/v1/jobs/{job['id']}").raise_for_status().json()
    if job["status"] != "successful":
        raise RuntimeError(f"{job['outcome']}: {job['message']}")
    return str(job["id"])


def of_a_dataset(client: httpx.Client, settings: Settings) -> list[Row]:
    """Parts of one dataset of 500 frames and 401 nodes, and the whole."""
    job = finished(client, {"case": "cantilever-vibration", "set": LARGE})
    data, t = f"/v1/jobs/{job}/data", "&t_min=2.5&t_max=2.5"

    def get(address: str) -> Callable[[], httpx.Response]:
        return lambda: client.get(address).raise_for_status()

    rows = [
        measured("last values of a job (/v1/scalars)", TIMES, get(f"/v1/scalars?jobs={job}&variables=Tw,Wr,Lk"),
                 "<= 10 ms"),
        measured("Tw, Wr, Lk of 501 frames, JSON", TIMES, get(f"{data}?variables=Tw,Wr,Lk"), "<= 10 ms"),
        measured("r of one frame, JSON", TIMES, get(f"{data}?variables=r{t}"), "<= 10 ms"),
        measured("r of one frame, Arrow", TIMES, get(f"{data}?variables=r&format=arrow{t}"), "<= 10 ms"),
        measured("r of all frames, NetCDF (4.8 MB)", 20, get(f"{data}?variables=r&format=netcdf")),
        measured("a chunk of r, Zarr", TIMES, get(f"/v1/jobs/{job}/zarr/r/c/3/0/0")),
        measured("r of one frame, OPeNDAP", TIMES, get(f"/v1/jobs/{job}/opendap.dods?r[250][0:1:400][0:1:2]")),
    ]
    return [*rows, _whole(client, settings)]


def _whole(client: httpx.Client, settings: Settings) -> Row:
    """A file of some 200 MB, read by curl, beside the disk read past the kernel's memory."""
    job = finished(client, {"case": "cantilever-vibration", "set": LARGE | {"t_end": 60.0}})
    [file] = settings.datasets.glob(f"{job}.*.nc")
    size = file.stat().st_size / 1e6
    address = str(client.base_url.join(f"/v1/jobs/{job}/dataset"))
    whole = measured("", 10, lambda: _read(file, "curl", "--silent", "--fail", "--output", os.devnull, address))
    disk = measured("", 10, lambda: _read(file, "dd", "iflag=direct", "bs=1M", f"if={file}", f"of={os.devnull}"))
    speed = [f"{size / fmean(row.seconds):.0f} MB/s" for row in (whole, disk)]
    what = f"a whole file of {size:.0f} MB, not in memory, by curl: {speed[0]}, from the disk by dd {speed[1]}"
    return replace(whole, what=what, aim="disk speed", control=disk)


def _read(file: Path, *command: str) -> None:
    """Run what reads a file, after the kernel was told to forget its pages."""
    with file.open("rb") as pages:
        os.posix_fadvise(pages.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)


def of_many_jobs(client: httpx.Client, settings: Settings) -> list[Row]:
    """A list of 10,000 jobs read page by page."""
    database = Database(settings.database_url)
    for _ in range(LISTED // AT_ONCE):
        new = [NewJob({"none": secrets.token_hex()}, "listed", "another") for _ in range(AT_ONCE)]
        with database.writing() as transaction:
            insert_jobs(transaction, new)
    database.close()
    address = first = "/v1/jobs?limit=100&owner=another"

    def turn() -> None:
        nonlocal address
        address = client.get(address).raise_for_status().json()["next"] or first

    return [measured(f"a page of 100 of {LISTED:,} jobs, to the last", LISTED // 100 - 1, turn, "p99 <= 20 ms")]


def of_an_ensemble(client: httpx.Client, _: Settings) -> list[Row]:
    """1000 members of the paper's case, accepted and asked for."""
    last: dict[str, Any] = {}

    def submit() -> None:
        nonlocal last
        values = (secrets.randbelow(10**9) * 1e-9 + np.linspace(0.0, 1.0, MEMBERS)).tolist()
        body = {"case": "goyal-2003", "set": MEMBER, "parameters": {"loads.damping": values}}
        last = client.post("/v1/ensembles", json=body).raise_for_status().json()

    accepted = measured("1000 members of goyal-2003 accepted", 5, submit, "<= 1 s")
    links = last["links"]
    return [
        accepted,
        measured("status of 1000 members", 20, lambda: client.get(links["self"]).raise_for_status()),
        measured("Tw of 1000 members, JSON", 20, lambda: client.get(links["scalars"] + "?variables=Tw")),
        Row("1000 members cancelled", timed_once(lambda: client.post(links["self"] + "/cancel").raise_for_status())),
    ]


def timed_once(ask: Callable[[], Any]) -> list[float]:
    """How long the only call took (s)."""
    began = time.perf_counter()
    ask()
    return [time.perf_counter() - began]

