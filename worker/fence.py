"""Ends this process when it could lose its job without knowing: by a timer of the kernel, not of Python."""

from __future__ import annotations

import signal

DUE = 1e-6
"""Zero would disarm the timer."""


def arm(seconds: float) -> None:
    """Have the kernel end this process after that time; its clock runs on while the process is stopped."""
    signal.setitimer(signal.ITIMER_REAL, max(seconds, DUE))


def disarm() -> None:
    """Let the process live."""
    signal.setitimer(signal.ITIMER_REAL, 0.0)
