"""hockle jobs, cancel, watch, pin, unpin, delete: the jobs of a server."""

from __future__ import annotations

import argparse
from datetime import UTC, datetime
from itertools import islice
from typing import Any

from hockle.connection import add_server, connected, follow, sentence

STATUSES = ("accepted", "running", "successful", "failed", "dismissed")


def register(subparsers: Any) -> None:
    """Add `hockle jobs`, `hockle cancel`, `hockle watch`, `hockle pin`, `hockle unpin` and `hockle delete`."""
    listing = subparsers.add_parser("jobs", help="list jobs, newest first")
    listing.add_argument("--status", choices=STATUSES, help="only jobs of this status")
    listing.add_argument("--label", help="only jobs with exactly this label")
    listing.add_argument("--since", type=time, metavar="TIME",
                         help="only jobs submitted then or later: a day, or a time as in the list (UTC)")
    listing.add_argument("--until", type=time, metavar="TIME", help="only jobs submitted before")
    listing.add_argument("--ensemble", metavar="ID", help="only members of this ensemble")
    listing.add_argument("-n", type=int, default=20, metavar="NUMBER", dest="many", help="at most so many (default 20)")
    listing.set_defaults(run=jobs)
    cancelling = subparsers.add_parser("cancel", help="cancel jobs")
    cancelling.add_argument("ids", metavar="ID", nargs="+")
    cancelling.set_defaults(run=cancel)
    pinning = subparsers.add_parser("pin", help="keep jobs: nobody deletes them")
    unpinning = subparsers.add_parser("unpin", help="let jobs be deleted")
    deleting = subparsers.add_parser("delete", help="delete jobs that have ended, with their datasets")
    for parser, command in ((pinning, pin), (unpinning, unpin), (deleting, delete)):
        parser.add_argument("ids", metavar="ID", nargs="+")
        parser.set_defaults(run=command)
    watching = subparsers.add_parser("watch", help="follow a job to its end")
    watching.add_argument("id", metavar="ID")
    watching.set_defaults(run=watch)
    add_server(listing, cancelling, watching, pinning, unpinning, deleting)


def jobs(arguments: argparse.Namespace) -> int:
    """Print a line for each job: id, status, progress, when it was submitted, label, title."""
    with connected(arguments.server) as client:
        listed = client.jobs(status=arguments.status, label=arguments.label, since=arguments.since,
                             until=arguments.until, ensemble=arguments.ensemble)
        for job in islice(listed, arguments.many):
            state = job.state
            print(f"{state.id}  {state.status:10}  {state.progress:4.0%}  {state.created:%Y-%m-%d %H:%M}"
                  f"  {state.label:12}  {state.title}".rstrip())
    return 0


def cancel(arguments: argparse.Namespace) -> int:
    """Cancel jobs, and print how each is doing then."""
    with connected(arguments.server) as client:
        for job_id in arguments.ids:
            state = client.job(job_id).cancel().state
            waits = " (it ends within a second)" if not state.ended else ""
            print(f"{sentence(state)}{waits}")
    return 0


def pin(arguments: argparse.Namespace) -> int:
    """Have jobs kept."""
    with connected(arguments.server) as client:
        for job_id in arguments.ids:
            client.job(job_id).pin()
    return 0


def unpin(arguments: argparse.Namespace) -> int:
    """Let jobs be deleted."""
    with connected(arguments.server) as client:
        for job_id in arguments.ids:
            client.job(job_id).unpin()
    return 0


def delete(arguments: argparse.Namespace) -> int:
    """Delete jobs that have ended."""
    with connected(arguments.server) as client:
        for job_id in arguments.ids:
            client.job(job_id).delete()
    return 0


def watch(arguments: argparse.Namespace) -> int:
    """Show a job to its end; 1 if it was not successful."""
    with connected(arguments.server) as client:
        ended = follow(client, arguments.id)
    print(sentence(ended))
    return 0 if ended.status == "successful" else 1


def time(text: str) -> datetime:
    """A day or a time in ISO 8601; UTC where it does not say. Raises ValueError."""
    named = datetime.fromisoformat(text)
    return named if named.tzinfo else named.replace(tzinfo=UTC)
