"""All that is kept, in a folder, and back from it: the registry as it is at one moment, and the datasets it names."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from service.jobs import Database, Dataset
from service.results import Datasets
from service.results.durable import sync
from service.settings import Settings
from service.store.check import FILE
from service.store.snapshot import bring_back, check_empty, datasets_in, save
from service.store.verification import all_jobs, look

REGISTRY, DATASETS = "registry.db", "datasets"
CHUNK = 1 << 20


def back_up(database: Database, settings: Settings, folder: Path) -> Iterator[str]:
    """Write a backup while the service runs; gives what could not be saved, a sentence each.

    A folder with an older backup is brought up to date: datasets never change, so only new ones are copied.
    """
    (folder / DATASETS).mkdir(mode=0o700, parents=True, exist_ok=True)
    save(database, folder / REGISTRY)
    named = datasets_in(folder / REGISTRY)
    for job_id, dataset in named.items():
        if fault := _copy(settings.datasets / dataset.file, dataset, folder / DATASETS / dataset.file):
            yield f"job {job_id}: its dataset {dataset.file} is {fault}"
    names = {dataset.file for dataset in named.values()}
    for old in (folder / DATASETS).iterdir():
        if FILE.fullmatch(old.name) and old.name not in names:
            old.unlink()
    sync(folder / DATASETS)


def restore(settings: Settings, folder: Path) -> Iterator[str]:
    """Bring a backup back to where nothing is kept yet; gives what is missing or damaged, a sentence each.

    Raises FileExistsError where something is kept, FileNotFoundError where there is no backup.
    """
    if not (folder / REGISTRY).is_file():
        raise FileNotFoundError(f"{folder} holds no backup: {REGISTRY} is not there")
    check_empty(settings.database_url)
    for dataset in datasets_in(folder / REGISTRY).values():
        with suppress(FileNotFoundError):  # it is told below
            shutil.copyfile(folder / DATASETS / dataset.file, settings.datasets / dataset.file)
            sync(settings.datasets / dataset.file)
    sync(settings.datasets)
    database = bring_back(folder / REGISTRY, settings.database_url)  # the last, so that it can all be done once more
    datasets = Datasets(settings.datasets, settings.copies, settings.objects)
    try:
        for job in all_jobs(database):
            published = look(database, datasets, job)
            if published is not None and published.fault:
                yield f"job {job.id}: its dataset {published.file} is {published.fault}"
    finally:
        database.close()


def _copy(source: Path, dataset: Dataset, target: Path) -> str:
    """Copy a dataset that is not copied yet; why that cannot be done, or nothing."""
    if target.is_file() and target.stat().st_size == dataset.bytes:
        return ""
    beside, digest = target.with_name(f"{target.name}.part"), hashlib.sha256()
    try:
        with source.open("rb") as reading, beside.open("wb") as writing:
            while chunk := reading.read(CHUNK):
                digest.update(chunk)
                writing.write(chunk)
        if digest.hexdigest() != dataset.sha256:
            return "damaged"
        sync(beside)
        beside.replace(target)
    except FileNotFoundError:
        return "not among the files here"
    finally:
        beside.unlink(missing_ok=True)
    return ""
