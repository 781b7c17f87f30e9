"""On the path of the served processes: their time of day is wrong by what a file says."""

import os
import time
from pathlib import Path

_file = Path(os.environ["HOCKLE_CHAOS_CLOCK"])
_true = time.time


def _wrong() -> float:
    try:
        return _true() + float(_file.read_text() or 0)
    except (OSError, ValueError):
        return _true()


time.time = _wrong
time.time_ns = lambda: int(1e9 * _wrong())
