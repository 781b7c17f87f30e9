"""hockle store: what the service keeps on this machine, checked, pruned, saved and brought back."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

from hockle.failure import Failure
from hockle.here import add_data, registry_of, settings_of


def register(subparsers: Any) -> None:
    """Add `hockle store check`, `prune`, `backup` and `restore`."""
    store = subparsers.add_parser("store", help="what the service keeps: check, prune, back up, restore")
    below = store.add_subparsers(required=True, metavar="COMMAND")
    checking = below.add_parser("check", help="compare rows and files, also while the service runs")
    checking.set_defaults(run=check)
    pruning = below.add_parser("prune", help="delete now what HOCKLE_KEEP_... say is kept no longer")
    pruning.add_argument("--dry-run", action="store_true", help="only tell which jobs these are")
    pruning.set_defaults(run=prune)
    saving = below.add_parser("backup", help="save registry and datasets, also while the service runs")
    saving.set_defaults(run=backup)
    restoring = below.add_parser("restore", help="bring a backup back to where nothing is kept yet")
    restoring.set_defaults(run=restore)
    for parser in (saving, restoring):
        parser.add_argument("folder", type=Path, metavar="FOLDER")
    add_data(checking, pruning, saving, restoring)


def check(arguments: argparse.Namespace) -> int:
    """Print what is not as it should be; 1 if some of it could not be set right."""
    from service.store.check import check

    settings, wrong = settings_of(arguments), 0
    with registry_of(settings) as database:
        for finding in check(database, settings):
            print(finding.sentence)
            wrong += not finding.repaired
    print(f"{wrong} faults are left" if wrong else "all is well")
    return 1 if wrong else 0


def prune(arguments: argparse.Namespace) -> int:
    """Delete jobs, and print their ids."""
    from service.results import Datasets
    from service.store.removal import remove_files
    from service.store.retention import overdue, retain

    settings = settings_of(arguments)
    with registry_of(settings) as database:
        ids = (overdue if arguments.dry_run else retain)(database, settings, time.time())
        if not arguments.dry_run:
            remove_files(database, Datasets(settings.datasets, settings.copies, settings.objects))
    print("\n".join([*ids, f"{len(ids)} jobs {'would be' if arguments.dry_run else 'are'} deleted"]))
    return 0


def backup(arguments: argparse.Namespace) -> int:
    """Write a backup; 1 if a dataset could not be saved."""
    from service.store.backup import back_up

    settings = settings_of(arguments)
    with registry_of(settings) as database:
        return _report(list(back_up(database, settings, arguments.folder)), f"saved to {arguments.folder}")


def restore(arguments: argparse.Namespace) -> int:
    """Bring a backup back; 1 if a dataset is missing or damaged."""
    from service.store.backup import restore

    try:
        return _report(list(restore(settings_of(arguments), arguments.folder)), f"restored from {arguments.folder}")
    except (FileExistsError, FileNotFoundError) as error:
        raise Failure(str(error)) from None


def _report(faults: list[str], summary: str) -> int:
    print("\n".join([*faults, summary if not faults else f"{summary}, but for {len(faults)} datasets"]))
    return 1 if faults else 0
