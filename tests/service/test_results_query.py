"""Subsets of a dataset."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from service.results import DatasetWriter, Ranges, SubsetTooLarge, UnknownVariable
from service.results import subset as part_of
from service.results.formats import as_data
from service.results.query import opened
from tests.service.frames import ended, frames, small_spec


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("results") / "out.nc"
    spec = small_spec(**{"output.fields": ["r", "f"]})
    with DatasetWriter(path, spec) as writer:
        for frame in frames(spec, 9):
            writer.append(frame)
        writer.publish("completed", "", ended(spec))
    return path


def subset(path: Path, names: list[str], limit: int = 1_000_000, **ranges: Any) -> dict[str, Any]:
    with opened(path) as source:
        return as_data(part_of(source, names, Ranges(**ranges), limit))


def test_a_subset_is_json_with_coordinates_and_units(path: Path):
    part = subset(path, ["f", "Tw"], t_min=1.0, t_max=2.0, s_min=0.5, s_stride=5)
    assert json.loads(json.dumps(part, allow_nan=False)) == part
    assert part["coordinates"]["time"] == {"units": "s", "values": [1.0, 1.5, 2.0]}
    assert part["coordinates"]["s"]["values"] == pytest.approx([0.5, 1.0])
    assert part["coordinates"]["body"] == {"values": ["a1", "a2", "a3"]}
    f = part["variables"]["f"]
    assert (f["dimensions"], f["units"]) == (["time", "s", "body"], "N")
    assert f["values"][1][0] == pytest.approx([202.0, 202.1, 202.2])
    assert part["variables"]["Tw"]["values"] == [12.0, 12.5, 13.0]


def test_strides_count_from_the_first_value_of_the_range(path: Path):
    part = subset(path, ["contacts"], t_min=0.4, time_stride=3)
    assert part["variables"]["contacts"]["values"] == [1, 4, 7]
    assert "s" not in part["coordinates"]


@pytest.mark.parametrize("stride", [10**6, 2**63 - 1, 2**63, 10**30])
def test_a_stride_past_the_end_leaves_the_first_value(path: Path, stride: int):
    first = subset(path, ["r"], time_stride=stride, s_stride=stride)
    assert first["coordinates"]["time"]["values"] == subset(path, ["Tw"])["coordinates"]["time"]["values"][:1]
    assert np.shape(first["variables"]["r"]["values"]) == (1, 1, 3)


def test_a_value_that_is_none_is_null(path: Path):
    assert subset(path, ["Wr"], t_max=0.5)["variables"]["Wr"]["values"] == [None, None]


@pytest.mark.parametrize("limits", [{"t_min": 100.0}, {"t_max": -1.0}, {"t_min": 2.0, "t_max": 1.0}])
def test_a_range_without_frames_is_empty(path: Path, limits: dict[str, float]):
    assert subset(path, ["r"], **limits)["variables"]["r"]["values"] == []


@pytest.mark.parametrize("name", ["kappa", "temperature", "s", "body"])
def test_a_variable_that_is_not_there_is_refused_with_those_that_are(path: Path, name: str):
    with pytest.raises(UnknownVariable, match=rf"one of f, r, energy_bending.*got '{name}'"):
        subset(path, [name])


def test_a_subset_beyond_the_limit_is_refused_before_it_is_read(path: Path):
    with pytest.raises(SubsetTooLarge, match="at most 593 values, got 594"):
        subset(path, ["r", "f"], limit=593)
    assert subset(path, ["r", "f"], limit=594)


@pytest.mark.parametrize("stride", [{"time_stride": 0}, {"s_stride": -1}])
def test_a_stride_below_one_is_refused(path: Path, stride: dict[str, Any]):
    with pytest.raises(ValueError, match="stride must be >= 1"):
        subset(path, ["r"], **stride)
