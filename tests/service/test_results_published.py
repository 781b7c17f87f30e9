"""Datasets in an object store: this host's copies of them, and what happens when it is away."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import pytest

from service.results import Datasets, StoreUnreachable, published
from service.results.bucket import CHUNK, Bucket

CONTENT = os.urandom(2 * CHUNK + 17)
TOLD = ("job.1.nc", len(CONTENT), hashlib.sha256(CONTENT).hexdigest())


@pytest.fixture
def directory(tmp_path: Path) -> Path:
    for name in ("work", "datasets", "copies"):
        (tmp_path / name).mkdir()
    return tmp_path


@pytest.fixture
def datasets(directory: Path, objects: str) -> Datasets:
    return Datasets(directory / "datasets", directory / "copies", objects)


def publish(datasets: Datasets, directory: Path, name: str = TOLD[0]) -> None:
    path = datasets.place(name, directory / "work")
    path.write_bytes(CONTENT)
    datasets.publish(path)


def copies(directory: Path) -> list[str]:
    return sorted(path.name for path in (directory / "copies").iterdir())


def test_what_is_published_is_an_object_and_not_kept_as_a_file(datasets, directory, held_objects):
    publish(datasets, directory)
    assert held_objects() == [TOLD[0]]
    assert list((directory / "datasets").iterdir()) == []
    assert isinstance(datasets.find(TOLD[0]), Bucket)
    assert b"".join(datasets.find(TOLD[0]).read(TOLD[0], 5, 2 * CHUNK)) == CONTENT[5 : 2 * CHUNK]


def test_an_object_is_copied_once(datasets, directory):
    publish(datasets, directory)
    path = datasets.file(*TOLD)
    assert path.read_bytes() == CONTENT
    datasets.discard(TOLD[0])
    assert datasets.file(*TOLD) == path
    assert copies(directory) == [TOLD[0]]


def test_a_file_that_goes_in_parts_comes_whole(datasets, directory):
    content = os.urandom(9_000_000)  # boto3 takes parts from 8 MiB on
    path = datasets.place("large.1.nc", directory / "work")
    path.write_bytes(content)
    datasets.publish(path)
    assert datasets.file("large.1.nc", len(content), hashlib.sha256(content).hexdigest()).read_bytes() == content


def test_an_object_that_is_another_than_was_published_is_not_taken(datasets, directory):
    publish(datasets, directory)
    with pytest.raises(StoreUnreachable, match="damaged"):
        datasets.file(*TOLD[:2], "0" * 64)
    assert copies(directory) == []


def test_the_copies_that_were_asked_for_longest_ago_make_room(datasets, directory, monkeypatch):
    monkeypatch.setattr(published, "ROOM", int(2.5 * len(CONTENT)))
    for number, age in ((1, 1000.0), (2, 3000.0), (3, 2000.0), (4, 0.0)):
        publish(datasets, directory, f"job.{number}.nc")
        path = datasets.file(f"job.{number}.nc", *TOLD[1:])
        os.utime(path, (path.stat().st_mtime - age,) * 2)
    assert copies(directory) == ["job.1.nc", "job.4.nc"]
    monkeypatch.setattr(published, "ROOM", 0)
    publish(datasets, directory, "job.5.nc")
    datasets.file("job.5.nc", *TOLD[1:])
    assert copies(directory) == ["job.4.nc", "job.5.nc"]  # the fourth may just be read


def test_files_from_before_the_object_store_stay_where_they_are(datasets, directory):
    before = Datasets(directory / "datasets", directory / "copies")
    publish(before, directory)
    assert datasets.find(TOLD[0]) == datasets.file(*TOLD) == directory / "datasets" / TOLD[0]


def test_a_dataset_that_is_nowhere_is_not_found(datasets, directory):
    datasets.discard(TOLD[0])
    with pytest.raises(FileNotFoundError):
        datasets.file(*TOLD)
    with pytest.raises(FileNotFoundError):
        Datasets(directory / "datasets", directory / "copies").find(TOLD[0])


def test_a_bucket_that_does_not_exist_is_not_an_object_that_is_missing(directory, objects):
    nowhere = Datasets(directory / "datasets", directory / "copies", "s3://no-such-bucket")
    for ask in (lambda: publish(nowhere, directory), lambda: nowhere.file(*TOLD), lambda: nowhere.discard(TOLD[0])):
        with pytest.raises(StoreUnreachable, match="object store refuses"):
            ask()
