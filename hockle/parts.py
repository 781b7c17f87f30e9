"""hockle api, hockle worker: one part of the service in this process, for a container, a unit or a host of its own."""

from __future__ import annotations

import argparse
import gc
import os
import socket
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from hockle.failure import Failure
from hockle.here import registry_of, settings_of

if TYPE_CHECKING:
    from service.settings import Settings

SINGLE_THREADED = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""One job, one core; and small matrices are slower on more."""


def register(subparsers: Any) -> None:
    """Add `hockle api` and `hockle worker`."""
    parser = subparsers.add_parser("api", help="run the API alone, in this process")
    add_address(parser)
    parser.add_argument("--fd", type=int, help="serve on this inherited socket instead")
    parser.set_defaults(run=api)
    parser = subparsers.add_parser("worker", help="run a worker alone; SIGTERM: finish running jobs, SIGQUIT: "
                                   "hand them to others with a checkpoint")
    add_workers(parser)
    parser.set_defaults(run=worker)


def add_address(parser: argparse.ArgumentParser) -> None:
    """Let a command say where the API listens."""
    parser.add_argument("--host", default="127.0.0.1", help="any other than loopback needs API keys")
    parser.add_argument("--port", type=_whole_number(0, 65535), default=8000, help="0 for any free one")


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Let a command say how many jobs run at the same time."""
    parser.add_argument("--workers", type=_whole_number(1, 1024), default=os.cpu_count() or 1,
                        help="jobs at the same time")


def _whole_number(least: int, most: int) -> Callable[[str], int]:
    def number(text: str) -> int:
        if not (text.isdecimal() and least <= int(text) <= most):
            raise argparse.ArgumentTypeError(f"must be a whole number from {least} to {most}, got {text!r}")
        return int(text)

    return number


def spare_collections() -> None:
    """Look for no garbage while this process starts: what it loads is there to stay, and to look through it takes a
    fifth of the time. Both parts look again once all is loaded, at what is made from then on."""
    gc.disable()


def api(arguments: argparse.Namespace) -> int:
    """Serve HTTP on an address, or on a listening socket that the parent process hands down, until a signal."""
    settings = settings_of(arguments)
    spare_collections()
    from service.api.serving import serve

    if arguments.fd is not None:
        serve(settings, socket.socket(fileno=arguments.fd))
        return 0
    [listening] = listening_on(settings, arguments.host, arguments.port)
    serve(settings, listening)
    return 0


def listening_on(settings: Settings, host: str, port: int, many: int = 1) -> list[socket.socket]:
    """Sockets that listen there, beyond loopback only if there are API keys. Raises Failure."""
    from service.access import KeyStore
    from service.api.listening import listen

    with registry_of(settings) as database:
        keys = KeyStore(database).any_good(time.time())
    try:
        return listen(host, port, keys, many)
    except (OSError, ValueError) as error:
        raise Failure(f"cannot listen on {host} port {port}: {error}") from None


def worker(arguments: argparse.Namespace) -> int:
    """Run jobs until a signal."""
    settings_of(arguments)
    spare_collections()
    from worker.app import app

    app.worker_main(["worker", "--loglevel", "INFO", "--concurrency", str(arguments.workers),
                     "--without-gossip", "--without-mingle"])  # fmt: skip
    return 0
