"""What tests of every package may use."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest

LONGEST = 60.0


@pytest.fixture
def until() -> Callable[[Callable[[], object], str], None]:
    """Wait until a condition holds; the bound only keeps a broken test from waiting forever."""

    def wait(condition: Callable[[], object], what: str = "") -> None:
        deadline = time.monotonic() + LONGEST
        while not condition():
            if time.monotonic() > deadline:
                pytest.fail(f"did not come about within {LONGEST:.0f} s: {what}")
            time.sleep(0.01)

    return wait
