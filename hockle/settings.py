"""--set KEY=VALUE on the command line."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from hockle.failure import Failure


def parse_settings(told: Iterable[str]) -> dict[str, Any]:
    """Values by dotted key; a value is JSON, or else a plain string. Raises Failure for one without `=`."""
    settings: dict[str, Any] = {}
    for one in told:
        key, equals, text = one.partition("=")
        if not (key and equals):
            raise Failure(f"--set takes KEY=VALUE, as numerics.intervals=400, got {one!r}")
        try:
            settings[key] = json.loads(text)
        except ValueError:
            settings[key] = text
    return settings
