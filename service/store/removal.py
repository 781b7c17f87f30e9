"""Removes the files of deleted jobs. Whoever was ended in the middle of it, another one goes on."""

from __future__ import annotations

import logging
import shutil

from service.jobs import Database
from service.jobs.deletion import pending_removals, removed
from service.results import Datasets

AT_ONCE = 100
log = logging.getLogger(__name__)


def remove_files(database: Database, datasets: Datasets) -> None:
    """Remove all that are noted. What cannot be removed now is tried again the next time."""
    while files := pending_removals(database, AT_ONCE):
        deleted = [file for file in files if _remove(datasets, file)]
        if deleted:
            removed(database, deleted)
        if len(deleted) < len(files):
            return


def _remove(datasets: Datasets, file: str) -> bool:
    try:
        datasets.discard(file)
        shutil.rmtree(datasets.states(file), ignore_errors=True)
    except OSError as error:
        log.warning("%s cannot be removed now: %s", file, error)
        return False
    return True
