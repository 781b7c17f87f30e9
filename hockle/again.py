"""hockle again: a job's case once more, with a change."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from hockle.connection import add_server, connected, follow, sentence


def register(subparsers: Any) -> None:
    """Add `hockle again`."""
    parser = subparsers.add_parser("again", help="hand in a job's case once more, with a change")
    parser.add_argument("id", metavar="ID")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings",
                        help="change a value of the case, as t_end=60 to go on beyond its end")
    parser.add_argument("--at", type=float, metavar="TIME", help="move its ends otherwise from this time (s) on:")
    for name in ("start", "end"):
        parser.add_argument(f"--{name}", action="append", default=[], metavar="NAME=VALUE",
                            help=f"a condition of its {name}, as omega3=0")
    parser.add_argument("--label", default="", help="a word of yours, to find the job by")
    parser.add_argument("--wait", action="store_true", help="follow the job to its end")
    parser.set_defaults(run=again)
    add_server(parser)


def again(arguments: argparse.Namespace) -> int:
    """Hand in the case and print the new job's id."""
    from hockle.settings import parse_settings

    change, start, end = (parse_settings(part) for part in (arguments.settings, arguments.start, arguments.end))
    with connected(arguments.server) as client:
        before = client.job(arguments.id)
        if arguments.at is None:
            job = before.again(set=change, label=arguments.label)
        else:
            job = before.fork(arguments.at, start=start, end=end, set=change, label=arguments.label)
        print(job.id, flush=True)
        if job.state.message:  # why it is computed from its start
            print(job.state.message, file=sys.stderr)
        if not arguments.wait:
            return 0
        ended = follow(client, job.id)
    print(sentence(ended))
    return 0 if ended.status == "successful" else 1
