"""The socket on which the API listens, and the rule which addresses it may have."""

from __future__ import annotations

import ipaddress
import socket
from functools import lru_cache
from typing import Any


def listen(host: str, port: int, keys: bool = False, many: int = 1) -> list[socket.socket]:
    """Listening sockets on one port, each with a share of the clients; beyond loopback only if there are API keys.

    Raises ValueError for a host that is refused, OSError if the port is taken.
    """
    if not (is_loopback(host) or keys):
        raise ValueError(f"host must be a loopback address while there is no API key, got {host!r}: "
                         "make one with hockle keys create")
    family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    with _bound(family, address, shared=False) as alone:  # a shared port may be anybody's of the same user
        address = alone.getsockname()
    opened = [_bound(family, address, shared=True) for _ in range(many)]
    for listening in opened:
        listening.listen(2048)
    return opened


def _bound(family: int, address: Any, shared: bool) -> socket.socket:
    listener = socket.socket(family, socket.SOCK_STREAM)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, int(shared))
    try:
        listener.bind(address)
    except OSError:
        listener.close()
        raise
    return listener


def on_loopback(listening: socket.socket) -> bool:
    """Whether only this machine can reach the socket."""
    return is_loopback(listening.getsockname()[0])


@lru_cache(256)  # asked of every request
def is_loopback(host: str) -> bool:
    """Whether a host name or address is this machine's own."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
