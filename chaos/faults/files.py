"""What lies on the disk is torn, or the disk is full."""

from __future__ import annotations

import os
import signal
from contextlib import suppress

from chaos.disk import fill
from chaos.faults.target import PUT_TOGETHER, Target
from chaos.served import send

FULL = 1.0
"""Seconds for which there is no room."""


def tear_checkpoint(target: Target) -> bool:
    """The newest checkpoint of a running job loses its end, and its process is killed."""
    picked = target.pick()
    if picked is None:
        return False
    checkpoints = sorted((target.served.settings.work / picked[0]).glob("checkpoint-*"))
    if not checkpoints or not send(picked[1], signal.SIGKILL):
        return False
    with suppress(OSError):
        os.truncate(checkpoints[-1], target.random.randrange(checkpoints[-1].stat().st_size))
        return True
    return False


def fill_disk(target: Target) -> bool:
    """Checkpoints, datasets, SQLite's database, logs and the broker's file have no room, for a while."""
    if not target.small_disk:
        return False
    ballast = target.served.settings.data / "ballast"
    fill(ballast)
    target.in_a_while(FULL, lambda: ballast.unlink(missing_ok=True))
    return True


def fill_disk_at_consolidation(target: Target) -> bool:
    """The same, from the moment when a dataset is put together."""
    return target.small_disk and target.ending(PUT_TOGETHER) is not None and fill_disk(target)
