"""hockle api, hockle worker: one part of the service in this process, for a container, a unit or a host of its own."""

from __future__ import annotations

import argparse
import os
import time
from typing import Any

from hockle.failure import Failure

SINGLE_THREADED = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""One job, one core; and small matrices are slower on more."""


def register(subparsers: Any) -> None:
    """Add `hockle api` and `hockle worker`."""
    parser = subparsers.add_parser("api", help="run the API alone, in this process")
    parser.add_argument("--host", default="127.0.0.1", help="any other than loopback needs API keys")
    parser.add_argument("--port", type=int, default=8000, help="0 for any free one")
    parser.add_argument("--fd", type=int, help="serve on this inherited socket instead")
    parser.set_defaults(run=api)
    parser = subparsers.add_parser("worker", help="run a worker alone; SIGTERM: finish running jobs, SIGQUIT: "
                                   "hand them to others with a checkpoint")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="jobs at the same time")
    parser.set_defaults(run=worker)


def api(told: argparse.Namespace) -> int:
    """Serve HTTP on an address, or on a listening socket that the parent process hands down, until a signal."""
    import socket

    from service.access import has_keys
    from service.api.listening import listen
    from service.api.serving import serve
    from service.settings import from_environment

    settings = from_environment()
    if told.fd is not None:
        serve(settings, socket.socket(fileno=told.fd))
        return 0
    try:
        [listening] = listen(told.host, told.port, has_keys(settings, time.time()))
    except (OSError, ValueError) as error:
        raise Failure(f"cannot listen on {told.host} port {told.port}: {error}") from None
    serve(settings, listening)
    return 0


def worker(told: argparse.Namespace) -> int:
    """Run jobs until a signal."""
    os.environ.update(SINGLE_THREADED | os.environ)
    from worker.app import app

    app.worker_main(["worker", "--loglevel", "INFO", "--concurrency", str(told.workers),
                     "--without-gossip", "--without-mingle"])  # fmt: skip
    return 0
