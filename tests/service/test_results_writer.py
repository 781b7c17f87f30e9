"""Datasets: what they hold, and that there is never half of one."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import resource
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from threading import Event, Thread
from types import SimpleNamespace
from typing import Any, get_args

import netCDF4
import numpy as np
import pytest
import xarray as xr

from service.cases import CaseSpec, parse_case
from service.cases.case import FieldName
from service.results import (
    VARIABLES,
    DatasetWriter,
    Published,
    durable,
    netcdf,
    open_dataset,
    segments,
    subset,
    writer,
)
from service.results.formats import as_data
from service.results.query import opened
from service.results.schema import stored_variables
from solver import VerifiedFrame
from solver.run.accuracy import judge
from tests.service.frames import ended, frames, nodes, small_spec

ROOT = Path(__file__).parents[2]


def write(path: Path, spec: CaseSpec, count: int) -> Published:
    with DatasetWriter(path, spec) as writer:
        for frame in frames(spec, count):
            writer.append(frame)
        return writer.publish("completed", "", ended(spec))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "out.nc"


def test_a_dataset_gives_back_every_frame(path: Path):
    spec = small_spec()
    write(path, spec, 7)
    with open_dataset(path) as dataset:
        assert dict(dataset.sizes) == {"time": 7, "s": 11, "body": 3, "lab": 3, "quaternion": 4}
        assert dataset.time.values.tolist() == [0.5 * i for i in range(7)]
        assert dataset.s.values == pytest.approx(nodes(spec))
        for i, frame in enumerate(frames(spec, 7)):
            for variable in stored_variables(spec):
                assert np.array_equal(dataset[variable.name][i], variable.of(frame), equal_nan=True), (
                    variable.name
                )


def test_components_are_chosen_by_their_names(path: Path):
    write(path, small_spec(), 2)
    with open_dataset(path) as dataset:
        assert float(dataset.f.sel(body="a2", s=0.0)[0]) == pytest.approx(200.1)
        assert float(dataset.r.sel(lab="e3", s=1.0)[1]) == pytest.approx(501.7)
        assert dataset["quaternion"].values.tolist() == ["w", "x", "y", "z"]


def test_a_plain_xarray_opens_it(path: Path):
    write(path, small_spec(), 2)
    with xr.open_dataset(path) as dataset:
        assert dataset.Tw.values.tolist() == [11.0, 11.5]
        assert (dataset.time.dtype, dataset.time.values.tolist()) == (float, [0.0, 0.5])


def test_every_variable_tells_its_unit_and_meaning(path: Path):
    write(path, small_spec(), 2)
    with open_dataset(path) as dataset:
        for name in [v.name for v in stored_variables(small_spec())] + ["time", "s"]:
            assert dataset[name].attrs["units"], name
            assert dataset[name].attrs["long_name"], name
        assert dataset.kappa.attrs["frame"] == "material"
        assert dataset.r.attrs["frame"] == "lab"


def test_a_dataset_explains_itself(path: Path):
    spec = small_spec()
    write(path, spec, 2)
    with open_dataset(path) as dataset:
        told = dataset.attrs
    assert parse_case(json.loads(told["case"])) == spec
    assert told["outcome"] == "completed"
    assert (told["steps"], told["failed_steps"], told["newton_iterations"]) == (12, 1, 34)
    assert told["cpu_time"] == 5.5
    assert told["numpy_version"] == np.__version__
    assert {"python_version", "numba_version", "hockle_version", "title", "summary"} <= set(told)


def test_it_passes_the_cf_checker(path: Path):
    checker = pytest.importorskip("compliance_checker.runner")
    write(path, small_spec(), 3)
    checker.CheckSuite.load_all_available_checkers()
    report = path.with_suffix(".json")
    _, exceptions = checker.ComplianceChecker.run_checker(
        str(path),
        ["cf:1.11"],
        verbose=0,
        criteria="lenient",
        output_filename=str(report),
        output_format="json",
    )
    assert not exceptions
    told = json.loads(report.read_text())["cf:1.11"]
    faults = [m for level in ("high", "medium") for p in told[f"{level}_priorities"] for m in p["msgs"]]
    # The checker would have s and the components stand before the time, and takes what is called time for a date.
    its_own = ("recommended order T, Z, Y, X", "'time' should have standard_name='time'")
    assert [m for m in faults if not any(opinion in m for opinion in its_own)] == []


def test_only_the_asked_fields_are_stored(path: Path):
    write(path, small_spec(**{"output.fields": ["r"]}), 2)
    with open_dataset(path) as dataset:
        assert "r" in dataset
        assert "kappa" not in dataset
        assert "Tw" in dataset


def test_the_fields_that_a_case_may_ask_for_are_those_along_the_rod():
    assert set(get_args(FieldName)) == {v.name for v in VARIABLES if v.along_rod}


def test_the_checksum_and_size_are_those_of_the_file(path: Path):
    published = write(path, small_spec(), 3)
    content = path.read_bytes()
    assert published == Published(hashlib.sha256(content).hexdigest(), len(content))


def test_many_segments_make_the_same_dataset_as_one(path: Path, monkeypatch: pytest.MonkeyPatch):
    spec = small_spec()
    write(path, spec, 9)
    monkeypatch.setattr(segments, "SEGMENT_BYTES", 10_000)  # four frames of 11 nodes with 23 numbers each
    other = path.with_name("other.nc")
    with DatasetWriter(other, spec) as writer:
        for i, frame in enumerate(frames(spec, 9)):
            writer.append(frame)
            assert len(list(path.parent.glob(".other.nc.work-*/segment-*.npz"))) == (i + 1) // 5
        writer.publish("completed", "", ended(spec))
    with open_dataset(path) as one, open_dataset(other) as many:
        xr.testing.assert_equal(one, many)


def test_frames_that_are_in_memory_at_the_end_take_no_other_way_to_the_disk(path: Path, monkeypatch):
    monkeypatch.setattr(segments, "write_segment", no_space)
    write(path, small_spec(), 3)
    with open_dataset(path) as dataset:
        assert dataset.sizes["time"] == 3


def test_only_what_packs_well_is_packed(path: Path):
    spec, rng = small_spec(), np.random.default_rng(1)
    with DatasetWriter(path, spec) as writer:
        for frame in frames(spec, 3):
            writer.append(replace(frame, r=rng.standard_normal(frame.r.shape), v=np.zeros_like(frame.v)))
        writer.publish("completed", "", ended(spec))
    with netCDF4.Dataset(path) as dataset:
        packed = {name: dataset[name].filters() for name in ("r", "v", "Tw")}
    assert {name: told["zlib"] for name, told in packed.items()} == {"r": False, "v": True, "Tw": False}
    assert all(told["fletcher32"] for told in packed.values())


@pytest.mark.parametrize(("count", "chunks"), [(1, 1), (103, 1), (104, 2), (341, 4)])
def test_the_last_chunk_is_hardly_shorter_than_the_others(path: Path, monkeypatch, count, chunks):
    spec = small_spec()
    monkeypatch.setattr(netcdf, "CHUNK_BYTES", 103 * 8 * 11 * 3)
    write(path, spec, count)
    with netCDF4.Dataset(path) as dataset:
        rows = dataset["r"].chunking()[0]
    assert (chunks - 1) * rows < count <= chunks * rows < count + chunks


def test_a_run_that_fails_before_its_first_frame_leaves_an_empty_dataset(path: Path):
    write(path, small_spec(), 0)
    with open_dataset(path) as dataset:
        assert dataset.sizes["time"] == 0


def test_nothing_but_the_dataset_is_left(path: Path):
    write(path, small_spec(), 3)
    assert list(path.parent.iterdir()) == [path]


def test_a_new_dataset_takes_the_place_of_the_old_one(path: Path):
    write(path, small_spec(), 3)
    write(path, small_spec(), 5)
    with open_dataset(path) as dataset:
        assert dataset.sizes["time"] == 5


def test_an_interrupted_run_leaves_nothing(path: Path):
    spec = small_spec()
    with pytest.raises(KeyboardInterrupt), DatasetWriter(path, spec) as writer:
        for frame in frames(spec, 3):
            writer.append(frame)
        raise KeyboardInterrupt
    assert list(path.parent.iterdir()) == []


def test_what_had_no_room_can_be_published_once_there_is_some(path: Path):
    spec = small_spec()
    with DatasetWriter(path, spec) as writer:
        for frame in frames(spec, 50):
            writer.append(frame)
        writer.flush()
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))
        try:
            with pytest.raises(OSError):
                writer.publish("completed", "", ended(spec))
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        writer.publish("completed", "", ended(spec))
    assert list(path.parent.iterdir()) == [path]
    with open_dataset(path) as dataset:
        assert dataset.sizes["time"] == 50


def no_space(*args: Any, **kwargs: Any) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def hdf_error(*args: Any, **kwargs: Any) -> None:
    raise RuntimeError("NetCDF: HDF error")


@pytest.mark.parametrize(
    ("module", "name", "fault"),
    [
        (np, "savez", no_space),
        (netCDF4, "Dataset", hdf_error),
        (netcdf, "verify", no_space),
        (durable.os, "fsync", no_space),
        (Path, "replace", no_space),
    ],
)
def test_a_full_disk_leaves_the_old_dataset_and_nothing_else(
    path: Path, monkeypatch: pytest.MonkeyPatch, module: Any, name: str, fault: Any
):
    path.write_bytes(b"the old one")
    monkeypatch.setattr(segments, "SEGMENT_BYTES", 1)
    with monkeypatch.context() as full:
        full.setattr(module, name, fault)
        with pytest.raises(OSError):
            write(path, small_spec(), 3)
    assert path.read_bytes() == b"the old one"
    assert list(path.parent.iterdir()) == [path]


LIMITED = """
import resource, signal, sys
from pathlib import Path
from threading import Event, Thread
from service.results import DatasetWriter, segments
from solver import VerifiedFrame
from tests.service.frames import ended, frames, nodes, small_spec
spec = small_spec(**{"numerics.intervals": 200})
segments.SEGMENT_BYTES = int(sys.argv[2])
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))
with DatasetWriter(Path(sys.argv[1]), spec) as writer:
    try:
        for frame in frames(spec, 300):
            writer.append(frame)
        writer.publish("completed", "", ended(spec))
    except OSError as error:
        sys.exit(f"OSError: {error}")
"""


@pytest.mark.parametrize("segment", [1_000_000, 70_000], ids=["segment", "dataset"])
def test_a_file_that_may_not_grow_is_a_clear_error(path: Path, segment: int):
    # No file may exceed 150 kB: first a segment does, then the dataset of many small segments.
    run = subprocess.run(
        [sys.executable, "-c", LIMITED, str(path), str(segment)], capture_output=True, text=True, cwd=ROOT
    )
    assert run.returncode == 1
    assert run.stderr.startswith("OSError: ")
    assert list(path.parent.iterdir()) == []


def test_a_file_that_does_not_come_to_the_disk_is_not_published(path: Path, monkeypatch: pytest.MonkeyPatch):
    """It does so while it is read back."""
    read = Event()

    def fail_late(_: int) -> None:
        assert read.wait(60)
        no_space()

    def sha256_of(file: Path) -> str:
        read.set()
        return durable.sha256_of(file)

    monkeypatch.setattr(durable.os, "fsync", fail_late)
    monkeypatch.setattr(writer, "sha256_of", sha256_of)
    with pytest.raises(OSError, match=os.strerror(errno.ENOSPC)):
        write(path, small_spec(), 3)
    assert list(path.parent.iterdir()) == []


def test_a_run_without_memory_for_a_thread_is_out_of_memory(path: Path, monkeypatch: pytest.MonkeyPatch):
    def refuse(*_: Any) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(Thread, "start", refuse)
    with pytest.raises(MemoryError):
        write(path, small_spec(), 3)


def test_a_damaged_file_is_not_published(path: Path, monkeypatch: pytest.MonkeyPatch):
    whole = netcdf.write

    def damage(beside: Path, *args: Any) -> None:
        whole(beside, *args)
        with netCDF4.Dataset(beside, "a") as dataset:
            dataset["Tw"][1] = 0.0

    monkeypatch.setattr(netcdf, "write", damage)
    with pytest.raises(OSError, match="Tw was not read back"):
        write(path, small_spec(), 3)
    assert list(path.parent.iterdir()) == []


KILLED = """
import os, signal, sys
from pathlib import Path
from threading import Event, Thread
from tests.service.frames import ended, frames, nodes, small_spec
from service.results import DatasetWriter
spec = small_spec()
writer = DatasetWriter(Path(sys.argv[1]), spec)
for frame in frames(spec, 3):
    writer.append(frame)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_what_a_killed_run_leaves_is_removed_by_the_next_one(path: Path):
    run = subprocess.run([sys.executable, "-c", KILLED, str(path)], cwd=ROOT)
    assert run.returncode == -9
    assert [left.name.startswith(".out.nc.work-") for left in path.parent.iterdir()] == [True]
    write(path, small_spec(), 2)
    assert list(path.parent.iterdir()) == [path]


def test_a_run_that_lives_is_left_alone_by_the_next_one(path: Path):
    spec = small_spec()
    with DatasetWriter(path, spec) as first:
        for frame in frames(spec, 2):
            first.append(frame)
        write(path, spec, 5)
        first.publish("completed", "", ended(spec))
    with open_dataset(path) as dataset:
        assert dataset.sizes["time"] == 2


def test_a_run_goes_on_from_the_segments_of_one_that_was_killed(path: Path):
    spec = small_spec()
    work = path.parent / "work"
    work.mkdir()
    all_frames = list(frames(spec, 9))
    with DatasetWriter(path.with_name("x.1.nc"), spec, work) as first:
        for frame in all_frames[:4]:
            first.append(frame)
        written = first.flush()
        first.append(all_frames[4])  # lost with its writer
    assert all(segment.is_whole(work) for segment in written)
    with DatasetWriter(path.with_name("x.2.nc"), spec, work, written) as second:
        for frame in all_frames[4:]:
            second.append(frame)
        second.publish("completed", "", ended(spec))
    write(path, spec, 9)
    with open_dataset(path) as one, open_dataset(path.with_name("x.2.nc")) as other:
        xr.testing.assert_identical(one.drop_attrs(), other.drop_attrs())


def test_a_torn_segment_is_known_for_one(path: Path):
    with DatasetWriter(path, small_spec(), path.parent) as writer:
        writer.append(next(frames(small_spec(), 1)))
        [segment] = writer.flush()
    file = path.parent / segment.name
    file.write_bytes(file.read_bytes()[:-1])
    assert not segment.is_whole(path.parent)
    file.unlink()
    assert not segment.is_whole(path.parent)


def verified_frames(spec: CaseSpec, count: int) -> list[VerifiedFrame]:
    """Frames whose errors are the frames of another time."""
    return [
        VerifiedFrame(**vars(frame), error=error)
        for frame, error in zip(frames(spec, count), list(frames(spec, count))[::-1], strict=True)
    ]


def test_a_verified_dataset_has_error_bars(path: Path):
    spec = small_spec(**{"numerics.verify": True, "output.fields": ["r"]})
    verified = verified_frames(spec, 3)
    with DatasetWriter(path, spec) as writer:
        for frame in verified:
            writer.append(frame)
        writer.publish("completed", "", ended(spec))
    with open_dataset(path) as dataset:
        assert dataset.r.attrs["ancillary_variables"] == "r_error"
        assert "ancillary_variables" not in dataset["dt"].attrs
        assert {"kappa", "kappa_error", "dt_error", "contacts_error"}.isdisjoint(dataset.variables)
        assert dataset.r_error.dims == dataset.r.dims
        assert dataset.r_error.attrs["units"] == "m"
        assert np.array_equal(dataset.r, [frame.r for frame in verified])
        assert np.array_equal(dataset.r_error, [frame.error.r for frame in verified])
        assert dataset.energy_bending_error.values.tolist() == [f.error.energy_bending for f in verified]
        assert "10 intervals and with 20" in dataset.attrs["history"]
    with opened(path) as source:
        told = as_data(subset(source, ["Tw_error"]))["variables"]["Tw_error"]
    assert told["long_name"] == "estimated error of Tw"


@pytest.mark.parametrize(("error", "words"), [(np.nan, "nothing tells the errors"), (1e-4, "extrapolated")])
def test_the_history_says_extrapolated_only_where_several_runs_came_to_their_end(path: Path, error: float, words: str):
    fixed, spec = (small_spec(numerics=numerics, **{"output.fields": ["r"]})
                   for numerics in ({"intervals": 10, "dt_max": 0.1}, {"tolerance": 1e-3}))  # fmt: skip
    run = SimpleNamespace(**vars(ended(fixed)), accuracy=judge(1e-3, np.full((3, 4), error)))
    with DatasetWriter(path, spec) as writer:
        for frame in verified_frames(fixed, 3):
            writer.append(frame)
        writer.publish("completed", "", run)
    with open_dataset(path) as dataset:
        assert words in dataset.attrs["history"]
