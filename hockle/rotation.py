"""Logs that do not grow for ever. A process goes on writing to the file that it has open: so a full log is copied, and
then emptied; what is written in the moment between the two is lost."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

KEPT = 4
"""Older logs that are kept beside each: NAME.log.1 is the newest."""


def rotate(log: Path, most: int) -> None:
    """Begin a log anew if it has more than `most` bytes. Where there is no room for another it goes on growing."""
    if not log.is_file() or log.stat().st_size <= most:
        return
    beside = log.with_name(f"{log.name}.part")
    try:
        shutil.copyfile(log, beside)
    except OSError:
        beside.unlink(missing_ok=True)
        return
    for number in range(KEPT - 1, 0, -1):
        older = log.with_name(f"{log.name}.{number}")
        if older.exists():
            older.replace(log.with_name(f"{log.name}.{number + 1}"))
    beside.replace(log.with_name(f"{log.name}.1"))
    os.truncate(log, 0)
