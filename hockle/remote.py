"""hockle submit, status, fetch: one job on a server."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from hockle.connection import add_server, connected, follow, sentence
from hockle.failure import Failure


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
    fetch_parser.add_argument("-o", "--output", type=Path, help="default ID.nc; *.glb is glTF, *.zip VTK for ParaView")
    fetch_parser.set_defaults(run=fetch)
    add_server(submit_parser, status_parser, fetch_parser)


def submit(arguments: argparse.Namespace) -> int:
    """Hand in a case and print the job's id."""
    from hockle.settings import read_case

    case = read_case(arguments.case, arguments.settings)
    with connected(arguments.server) as client:
        job = client.submit(case, label=arguments.label, again=arguments.again)
        print(job.id, flush=True)
        if not arguments.wait:
            return 0
        ended = follow(client, job.id)
    print(sentence(ended))
    return 0 if ended.status == "successful" else 1


def status(arguments: argparse.Namespace) -> int:
    """Print how a job is doing."""
    with connected(arguments.server) as client:
        job = client.job(arguments.id).state
    print(job.model_dump_json(indent=2) if arguments.json else sentence(job))
    return 0


def fetch(arguments: argparse.Namespace) -> int:
    """Write a job's dataset to a file."""
    path = arguments.output or Path(f"{arguments.id}.nc")
    with connected(arguments.server) as client:
        try:
            job = client.job(arguments.id)
            size = job.export(path) if path.suffix in (".glb", ".zip") else job.fetch(path)
        except OSError as error:
            raise Failure(f"cannot write {path}: {error}") from None
    print(f"{path} ({size / 1e6:.1f} MB)")
    return 0
