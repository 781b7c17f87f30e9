"""hockle serve: the service, until Ctrl-C."""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import replace
from pathlib import Path
from typing import Any


def register(subparsers: Any) -> None:
    """Add `hockle serve`."""
    parser = subparsers.add_parser("serve", help="run API, worker and broker until Ctrl-C")
    parser.add_argument("--host", default="127.0.0.1", help="any other than loopback needs API keys")
    parser.add_argument("--port", type=int, default=8000, help="0 for any free one")
    parser.add_argument("--data", type=Path, help="directory of all it keeps (default HOCKLE_DATA, or ./var)")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="jobs at the same time")
    parser.set_defaults(run=serve)


def serve(told: argparse.Namespace) -> int:
    """Run the service until a signal."""
    from hockle.supervisor import Services, stop_on_signals
    from service.settings import from_environment

    settings = from_environment()
    if told.data is not None:
        settings = replace(settings, data=told.data)
    stop_on_signals()
    with Services(settings, told.host, told.port, told.workers) as services:
        print(f"hockle serves at {services.address}, data in {settings.data.absolute()}; Ctrl-C stops it",
              flush=True)
        try:
            while True:
                time.sleep(0.5)
                services.look_after()
        except KeyboardInterrupt:
            print("stopping", flush=True)
    return 0
