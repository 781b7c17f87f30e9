"""`python -m service.api`: the API in this process, on loopback only."""

from __future__ import annotations

import argparse
import socket

import uvicorn

from service.api.app import create_app
from service.api.listening import listen
from service.settings import from_environment


def main() -> None:
    """Serve on an address, or on a listening socket that the parent process hands down."""
    parser = argparse.ArgumentParser(prog="python -m service.api", description=__doc__)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=8000)
    parser.add_argument("--fd", type=int, help="serve on this inherited socket instead")
    told = parser.parse_args()
    listening = socket.socket(fileno=told.fd) if told.fd is not None else listen(told.host, told.port)
    config = uvicorn.Config(create_app(from_environment()), log_level="warning", server_header=False)
    uvicorn.Server(config).run(sockets=[listening])


if __name__ == "__main__":
    main()
