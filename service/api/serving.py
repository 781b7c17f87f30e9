"""The API in this process, on a listening socket."""

from __future__ import annotations

import socket

import uvicorn

from service.api.app import create_app
from service.api.connections import bounded, bounds_here
from service.api.listening import on_loopback
from service.logs import write_json
from service.settings import Settings


def serve(settings: Settings, listening: socket.socket) -> None:
    """Answer requests until a signal; beyond loopback every request needs an API key."""
    app = create_app(settings, keyed=settings.require_keys or not on_loopback(listening))
    write_json()
    config = uvicorn.Config(app, log_config=None, log_level="warning", access_log=False, server_header=False,
                            http=bounded(bounds_here()), ws="none",
                            proxy_headers=False)  # nothing here depends on the client's address or scheme
    uvicorn.Server(config).run(sockets=[listening])
