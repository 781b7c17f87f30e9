"""Numbers in headers and queries, which come as text."""

from __future__ import annotations

from pydantic import BeforeValidator


def _digits(value: object) -> object:
    """The text of a whole number, with no other spelling of it (`+0.0`, `1_0`). Raises ValueError."""
    if isinstance(value, str) and not value.removeprefix("-").isdecimal():
        raise ValueError("must be a whole number in digits")
    return value


WHOLE = BeforeValidator(_digits)
"""Beside `int`, after its bounds."""
