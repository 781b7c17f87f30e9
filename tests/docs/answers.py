"""Whether a program answers what a page shows: `...` stands for what is left out."""

from __future__ import annotations

import json
import math
import re
from typing import Any

LEFT_OUT = re.compile(r",?\s*\.\.\.")
NUMBER = re.compile(r"(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?)")
ID = re.compile(r"\b0[0-9a-z]{25}\b")
CLOSE = {"rel_tol": 0.05, "abs_tol": 1e-9}
"""Pages show a few digits, and zeros that rounding has left."""


def agrees(shown: str, answer: str) -> bool:
    """JSON is compared field by field, other text word by word; numbers are close, but for the CPU's time."""
    try:
        return _holds(json.loads(LEFT_OUT.sub("", shown)), json.loads(answer))
    except ValueError:
        beginning, cut, _ = shown.strip().partition("...")
    return answer.startswith(beginning.rstrip()) if cut else _same_words(shown.strip(), answer.strip())


def _holds(part: Any, whole: Any) -> bool:
    if isinstance(part, dict):
        return isinstance(whole, dict) and all(key in whole and _holds(one, whole[key]) for key, one in part.items())
    if isinstance(part, list):
        return isinstance(whole, list) and len(part) <= len(whole) and all(map(_holds, part, whole))
    if isinstance(part, float):
        return isinstance(whole, (int, float)) and math.isclose(part, whole, **CLOSE)
    return bool(part == whole)


def _same_words(shown: str, answer: str) -> bool:
    ours, theirs = NUMBER.split(shown), NUMBER.split(answer)
    if ours[::2] != theirs[::2]:
        return False
    return all(words.endswith("CPU ") or math.isclose(float(one), float(other), **CLOSE)
               for words, one, other in zip(ours[::2], ours[1::2], theirs[1::2], strict=False))  # fmt: skip
