"""/v1/jobs/{id}/film: the frames as the dashboard draws them."""

from __future__ import annotations

import json
from math import prod
from typing import Any

import numpy as np
import pytest

from service.results import film as films
from service.results import open_dataset


def read(content: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """The header, and each block by its name."""
    length = int.from_bytes(content[:4], "little")
    header, at = json.loads(content[4 : 4 + length]), 4 + length
    blocks = {}
    for block in header["blocks"]:
        shape = (len(header["time"]), len(header["s"]), block["components"])
        blocks[block["name"]] = np.frombuffer(content, "<f4", prod(shape), at).reshape(shape)
        at += blocks[block["name"]].nbytes
    assert at == len(content)
    return header, blocks


def dataset(client, settings, job_id):
    return open_dataset(next(settings.datasets.glob(f"{job_id}*.nc")))


def test_a_film_holds_shape_axes_and_colours_of_the_dataset(client, settings, done):
    header, blocks = read(client.get(f"/v1/jobs/{done}/film").content)
    with dataset(client, settings, done) as ds:
        assert header["time"] == ds.time.values.tolist()
        assert blocks["r"] == pytest.approx(ds.r.values, rel=1e-6, abs=1e-7)
        assert blocks["orientation"] == pytest.approx(ds.orientation.values, abs=1e-6)
        assert blocks["twist"][..., 0] == pytest.approx(ds.kappa.values[..., 2], rel=1e-6, abs=1e-30)
        assert blocks["tension"][..., 0] == pytest.approx(ds.f.values[..., 2], rel=1e-6, abs=1e-30)
        assert blocks["curvature"].max() == pytest.approx(ds.max_curvature.max())
    assert "error" not in blocks


def test_only_frames_after_a_time_are_given(client, done):
    header, _ = read(client.get(f"/v1/jobs/{done}/film?since=0.02").content)
    assert header["time"] == pytest.approx([0.03, 0.04, 0.05])
    header, blocks = read(client.get(f"/v1/jobs/{done}/film?since=9").content)
    assert header["time"] == [] and blocks["r"].shape == (0, 9, 3)


def test_long_films_are_thinned_out_in_time(client, done, monkeypatch):
    monkeypatch.setattr(films, "MOST_NODE_FRAMES", 30)
    header, _ = read(client.get(f"/v1/jobs/{done}/film").content)
    assert header["time"] == pytest.approx([0.0, 0.02, 0.04])
    header, _ = read(client.get(f"/v1/jobs/{done}/film?since=0.0").content)
    assert header["time"] == pytest.approx([0.02, 0.04])


def test_many_nodes_are_thinned_out_to_both_ends(client, done, monkeypatch):
    monkeypatch.setattr(films, "MOST_NODES", 5)
    header, blocks = read(client.get(f"/v1/jobs/{done}/film").content)
    assert (header["s"][0], header["s"][-1]) == (0.0, 1.0) and len(header["s"]) == 5
    assert blocks["r"].shape[1] == 5


def test_a_dataset_without_a_shape_has_no_film(client, registry, settings, case):
    from worker.run import run_next

    job_id = client.post("/v1/jobs", json={"case": case, "set": {"output.fields": ["r"]}}).json()["id"]
    assert client.get(f"/v1/jobs/{job_id}/film").status_code == 409
    run_next(registry.database, settings)
    answer = client.get(f"/v1/jobs/{job_id}/film")
    assert answer.status_code == 422 and "output.fields must have r and orientation" in answer.json()["detail"]
