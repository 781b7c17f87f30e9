"""The Prefer header (RFC 7240): how long the client would rather wait."""

from __future__ import annotations

LONGEST_WAIT = 60


def wait_preferred(prefer: str | None) -> int | None:
    """The seconds of `wait=`, at most LONGEST_WAIT; None without it. What is not understood is ignored."""
    for preference in (prefer or "").split(","):
        name, _, value = preference.partition(";")[0].partition("=")
        digits = value.strip().strip('"')
        if name.strip().lower() == "wait" and digits.isascii() and digits.isdigit():
            return min(int(digits[:6]), LONGEST_WAIT)
    return None
