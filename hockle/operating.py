"""hockle queue, pause, resume, requeue: what operators do with a server."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from hockle.connection import add_server, connected, sentence

if TYPE_CHECKING:
    from hockle_client.documents import PauseInfo, Workforce


def register(subparsers: Any) -> None:
    """Add `hockle queue`, `hockle pause`, `hockle resume` and `hockle requeue`."""
    looking = subparsers.add_parser("queue", help="how many jobs wait and run, on which hosts, and what is paused")
    looking.set_defaults(run=queue)
    pausing = subparsers.add_parser("pause", help="have workers take no more jobs")
    pausing.add_argument("--drain", action="store_true", help="also hand back what they run, with a checkpoint")
    pausing.set_defaults(run=pause)
    resuming = subparsers.add_parser("resume", help="have workers take jobs again")
    resuming.set_defaults(run=resume)
    for parser in (pausing, resuming):
        parser.add_argument("--host", help="only the workers of this host, as `hockle queue` names it")
    requeuing = subparsers.add_parser("requeue", help="run the cases of failed jobs once more")
    requeuing.add_argument("ids", metavar="ID", nargs="+")
    requeuing.set_defaults(run=requeue)
    add_server(looking, pausing, resuming, requeuing)


def queue(arguments: argparse.Namespace) -> int:
    """Print a line for the jobs, and one for each host."""
    with connected(arguments.server) as client:
        _show(client.workforce())
    return 0


def pause(arguments: argparse.Namespace) -> int:
    """Pause, and print how it is then."""
    with connected(arguments.server) as client:
        _show(client.pause(arguments.host, drain=arguments.drain))
    return 0


def resume(arguments: argparse.Namespace) -> int:
    """Go on, and print how it is then."""
    with connected(arguments.server) as client:
        _show(client.resume(arguments.host))
    return 0


def requeue(arguments: argparse.Namespace) -> int:
    """Print each new job."""
    with connected(arguments.server) as client:
        for job_id in arguments.ids:
            print(sentence(client.job(job_id).requeue().state))
    return 0


def _show(now: Workforce) -> None:
    print(f"queue: {now.waiting} waiting, {now.running} running{_pause_text(now.paused)}")
    for host in now.hosts:
        print(f"{host.name}: {host.workers} workers{_pause_text(host.paused)}")


def _pause_text(pause: PauseInfo | None) -> str:
    if pause is None:
        return ""
    return f", {'drained' if pause.drains else 'paused'} by {pause.owner} since {pause.since:%Y-%m-%d %H:%M}"
