"""A case as the command line names it: CASE, and --set KEY=VALUE."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from typing import Any

from hockle.failure import Failure

DECIMAL = re.compile(r"[+-]?(\d+\.\d*|\.\d+)([eE][+-]?\d+)?")
"""Numbers that people write, and JSON does not know: .5, 5. and +5.0."""


def parse_settings(texts: Iterable[str]) -> dict[str, Any]:
    """Values by dotted key: JSON, decimal numbers, or else plain strings. Raises Failure for one without `=`."""
    settings: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not (key and equals):
            raise Failure(f"--set takes KEY=VALUE, as numerics.intervals=400, got {text!r}")
        try:
            settings[key] = json.loads(value)
        except ValueError:
            settings[key] = float(value) if DECIMAL.fullmatch(value) else value
    return settings


def read_case(name_or_path: str, texts: Iterable[str]) -> dict[str, Any]:
    """The raw case of a shipped name or a file, with the settings applied. Raises Failure."""
    from service.cases import CaseError, apply_settings, load_case

    try:
        return apply_settings(load_case(name_or_path), parse_settings(texts))
    except (CaseError, OSError) as error:
        raise Failure(str(error)) from None
