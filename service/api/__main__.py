"""`python -m service.api`: the API in this process; on loopback, or anywhere once there are API keys."""

from __future__ import annotations

import argparse
import socket
import time

import uvicorn

from service.access import has_keys
from service.api.app import create_app
from service.api.connections import bounded, bounds_here
from service.api.listening import listen, on_loopback
from service.logs import write_json
from service.settings import Settings, from_environment


def main() -> None:
    """Serve on an address, or on a listening socket that the parent process hands down."""
    parser = argparse.ArgumentParser(prog="python -m service.api", description=__doc__)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=8000)
    parser.add_argument("--fd", type=int, help="serve on this inherited socket instead")
    told = parser.parse_args()
    settings = from_environment()
    listening = _socket(told, settings)
    app = create_app(settings, keyed=settings.require_keys or not on_loopback(listening))
    write_json()
    config = uvicorn.Config(app, log_config=None, log_level="warning", access_log=False, server_header=False,
                            http=bounded(bounds_here()), ws="none")
    uvicorn.Server(config).run(sockets=[listening])


def _socket(told: argparse.Namespace, settings: Settings) -> socket.socket:
    if told.fd is not None:
        return socket.socket(fileno=told.fd)
    [listening] = listen(told.host, told.port, has_keys(settings, time.time()))
    return listening


if __name__ == "__main__":
    main()
