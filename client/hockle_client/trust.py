"""Whom a client trusts where the server's address begins with https."""

from __future__ import annotations

import ssl
from functools import cache

import httpx


@cache
def trusted() -> ssl.SSLContext:
    """The certificates that httpx brings, read once: to read them takes longer than a request."""
    return httpx.create_ssl_context(trust_env=False)
