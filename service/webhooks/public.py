"""Connections to public addresses only, checked on the very address that is connected to."""

from __future__ import annotations

import ipaddress
import socket
from collections.abc import Iterable
from typing import Any

import httpcore

COMPATIBLE = ipaddress.ip_network("::/96")
"""IPv4 in IPv6 as it was once written, ::192.0.2.1; :: and ::1 lie there too."""
NAT64 = ipaddress.ip_network("64:ff9b::/32")


class NotPublic(Exception):
    """The name leads to an address that is not of the public internet."""


def is_public(address: str) -> bool:
    """Whether an address is of the public internet, and so is what it wraps (IPv4 in IPv6)."""
    ip = ipaddress.ip_address(address.partition("%")[0])
    if isinstance(ip, ipaddress.IPv6Address):
        if ip in COMPATIBLE or ip in NAT64 or ip.sixtofour is not None or ip.teredo is not None or ip.is_site_local:
            return False
        if ip.ipv4_mapped is not None:
            ip = ip.ipv4_mapped
    return ip.is_global and not ip.is_multicast


class PublicOnly(httpcore.NetworkBackend):
    """Resolves a name once, and connects to what it found if all of it is public: no second answer is asked for."""

    def __init__(self) -> None:
        self._below = httpcore.SyncBackend()

    def connect_tcp(self, host: str, port: int, timeout: float | None = None, local_address: str | None = None,
                    socket_options: Iterable[Any] | None = None) -> httpcore.NetworkStream:
        """Raises NotPublic, or httpcore.ConnectError."""
        try:
            found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        except OSError as error:
            raise httpcore.ConnectError(f"{host} has no address: {error}") from None
        addresses = [str(entry[4][0]) for entry in found]
        for address in addresses:
            if not is_public(address):
                raise NotPublic(f"{host} leads to {address}, which is not a public address")
        return self._below.connect_tcp(addresses[0], port, timeout, local_address, socket_options)

    def sleep(self, seconds: float) -> None:
        """Wait."""
        self._below.sleep(seconds)
