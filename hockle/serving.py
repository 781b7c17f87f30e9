"""hockle serve: the service, until Ctrl-C."""

from __future__ import annotations

import argparse
import time
from typing import Any

from hockle.here import add_data, settings_of
from hockle.parts import add_address, add_workers


def register(subparsers: Any) -> None:
    """Add `hockle serve`."""
    parser = subparsers.add_parser("serve", help="run API, worker and broker until Ctrl-C")
    add_address(parser)
    add_data(parser)
    add_workers(parser)
    parser.set_defaults(run=serve)


def serve(arguments: argparse.Namespace) -> int:
    """Run the service until a signal."""
    from hockle.supervisor import Services, stop_on_signals

    settings = settings_of(arguments)
    stop_on_signals()
    with Services(settings, arguments.host, arguments.port, arguments.workers) as services:
        print(f"hockle serves at {services.address}, data in {settings.data.absolute()}; Ctrl-C stops it",
              flush=True)
        try:
            while True:
                time.sleep(0.5)
                services.look_after()
        except KeyboardInterrupt:
            print("stopping", flush=True)
    return 0
