"""Connections to public addresses only, checked on the very address that is connected to."""

from __future__ import annotations

import ipaddress
import socket
from collections.abc import Iterable
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

import httpcore

GLOBAL_UNICAST = ipaddress.ip_network("2000::/3")
"""All that is given out of IPv6. What wraps an IPv4 address lies beside it (::192.0.2.1, ::ffff:0:192.0.2.1, NAT64),
but for what `_wraps` tells."""
DOCUMENTATION = ipaddress.ip_network("3fff::/20")
ISATAP = 0x5EFE
"""The third 16 bits from the right, of an address whose last 32 are an IPv4 address of some site."""
SPACE, DELETE = 0x20, 0x7F
PRIVATE_NAMES = ("localhost", "local", "internal", "localdomain", "lan", "home.arpa", "onion")


class NotPublic(Exception):
    """The name leads to an address that is not of the public internet."""


def is_public(address: str) -> bool:
    """Whether an address is of the public internet, and so is what it wraps (IPv4 in IPv6)."""
    ip = ipaddress.ip_address(address.partition("%")[0])
    if isinstance(ip, ipaddress.IPv6Address):
        if ip.ipv4_mapped is not None:
            ip = ip.ipv4_mapped
        elif ip not in GLOBAL_UNICAST or ip in DOCUMENTATION or _wraps(ip):
            return False
    return ip.is_global and not ip.is_multicast


def _wraps(ip: ipaddress.IPv6Address) -> bool:
    """Whether it leads to an IPv4 address through a tunnel."""
    return ip.sixtofour is not None or ip.teredo is not None or int(ip) >> 32 & 0xFFFF == ISATAP


def fault_of(url: str) -> str:
    """The rule that an address breaks to which nothing is sent, as far as it can be told without asking for its name;
    else nothing."""
    if any(ord(letter) <= SPACE or ord(letter) == DELETE for letter in url):
        return "must have no spaces and no control characters"
    try:
        parts = urlsplit(url)
        host, _ = (parts.hostname or "").rstrip("."), parts.port
    except ValueError as error:
        return f"must be an address: {error}"
    if not host or parts.username is not None:
        return "must name a host, and no user"
    if _is_private(host):
        return "must lead to the public internet"
    return ""


def _is_private(host: str) -> bool:
    with suppress(ValueError):
        return not is_public(host)
    with suppress(OSError):
        return not is_public(socket.inet_ntoa(socket.inet_aton(host)))  # 0x7f.1 and the like
    return "." not in host or f".{host}".endswith(tuple(f".{name}" for name in PRIVATE_NAMES))


class PublicOnly(httpcore.NetworkBackend):
    """Resolves a name once, and connects to what it found if all of it is public: no second answer is asked for."""

    def __init__(self) -> None:
        self._below = httpcore.SyncBackend()

    def connect_tcp(self, host: str, port: int, timeout: float | None = None, local_address: str | None = None,
                    socket_options: Iterable[Any] | None = None) -> httpcore.NetworkStream:
        """Raises NotPublic, or httpcore.ConnectError."""
        try:
            entries = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
        except OSError as error:
            raise httpcore.ConnectError(f"{host} has no address: {error}") from None
        addresses = [str(entry[4][0]) for entry in entries]
        for address in addresses:
            if not is_public(address):
                raise NotPublic(f"{host} leads to {address}, which is not a public address")
        return self._below.connect_tcp(addresses[0], port, timeout, local_address, socket_options)

    def sleep(self, seconds: float) -> None:
        """Wait."""
        self._below.sleep(seconds)
