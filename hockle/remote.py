"""hockle submit, status, fetch: the commands that talk to a server."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any


def register(subparsers: Any) -> None:
    """Add `hockle submit`, `hockle status` and `hockle fetch`."""
    submit_parser = subparsers.add_parser("submit", help="hand a case to a server")
    submit_parser.add_argument("case", metavar="CASE", help="a shipped name or a file")
    submit_parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings",
                               help="change a value of the case, as numerics.intervals=400")
    submit_parser.add_argument("--label", default="", help="a word of yours, to find the job by")
    submit_parser.add_argument("--again", action="store_true", help="run it even if the same case has run before")
    submit_parser.add_argument("--wait", action="store_true", help="follow the job to its end")
    submit_parser.set_defaults(run=submit)
    status_parser = subparsers.add_parser("status", help="how a job is doing")
    status_parser.add_argument("id", metavar="ID")
    status_parser.add_argument("--json", action="store_true", help="all that the server says")
    status_parser.set_defaults(run=status)
    fetch_parser = subparsers.add_parser("fetch", help="get a job's dataset")
    fetch_parser.add_argument("id", metavar="ID")
    fetch_parser.add_argument("-o", "--output", type=Path, help="default ID.nc")
    fetch_parser.set_defaults(run=fetch)
    for parser in (submit_parser, status_parser, fetch_parser):
        parser.add_argument("--server", metavar="URL", help="default HOCKLE_SERVER, or http://127.0.0.1:8000")


def submit(told: argparse.Namespace) -> int:
    """Hand in a case and print the job's id."""
    from hockle.client import Client
    from hockle.progress import show
    from hockle.settings import read_case

    case = read_case(told.case, told.settings)
    with Client(told.server) as client:
        job = client.submit(case, told.label, told.again)
        print(job["id"], flush=True)
        if not told.wait:
            return 0
        job = show(client.follow(job["id"]))
    print(_sentence(job))
    return 0 if job["status"] == "successful" else 1


def status(told: argparse.Namespace) -> int:
    """Print how a job is doing."""
    from hockle.client import Client

    with Client(told.server) as client:
        job = client.job(told.id)
    print(json.dumps(job, indent=2) if told.json else _sentence(job))
    return 0


def fetch(told: argparse.Namespace) -> int:
    """Write a job's dataset to a file."""
    from hockle.client import Client

    path = told.output or Path(f"{told.id}.nc")
    with Client(told.server) as client:
        size = client.fetch(told.id, path)
    print(f"{path} ({size / 1e6:.1f} MB)")
    return 0


def _sentence(job: dict[str, Any]) -> str:
    told = f"{job['id']}: {job['status']}"
    if job["status"] == "running":
        told += f", {job['phase'] or 'starting'}, {job['progress']:.0%} done, t = {job['t']:.2f} s"
    if job["outcome"] not in ("", "completed"):
        told += f", {job['outcome']}"
    if job["message"]:
        told += f": {job['message']}"
    return told
