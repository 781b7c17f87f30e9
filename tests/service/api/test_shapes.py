"""The moving rod for other programs: VTK for ParaView, glTF for Blender and browsers."""

from __future__ import annotations

import io
import json
import math
import xml.etree.ElementTree as ET
import zipfile

import numpy as np
import pytest

from service.results import vtk
from service.results.query import DatasetSource, opened
from service.results.vtk import vtk_archive
from solver import Outcome, RunFailed, simulate


@pytest.fixture
def values(client, done):
    return {name: np.array(client.get(f"/v1/jobs/{done}/data?variables={name}").json()["variables"][name]["values"])
            for name in ("r", "kappa", "orientation")}


@pytest.fixture
def times(client, done):
    return client.get(f"/v1/jobs/{done}/data?variables=Tw").json()["coordinates"]["time"]["values"]


def archive(client, job_id, query=""):
    answer = client.get(f"/v1/jobs/{job_id}/vtk{query}")
    assert answer.status_code == 200, answer.text
    return zipfile.ZipFile(io.BytesIO(answer.content))


def array(vtp: bytes, name: str, type: str) -> np.ndarray:
    """An array of a VTP file, by the format's own rules."""
    head, _, data = vtp.partition(b'<AppendedData encoding="raw">\n_')
    [told] = [one for one in ET.fromstring(head + b"</VTKFile>").iter("DataArray") if one.get("Name") == name]
    at = int(told.get("offset"))
    size = int.from_bytes(data[at : at + 8], "little")
    values = np.frombuffer(data[at + 8 : at + 8 + size], type)
    return values.reshape(-1, int(told.get("NumberOfComponents", 1)))


def test_a_collection_names_a_file_for_each_time_with_the_values_to_the_bit(client, done, values, times):
    files = archive(client, done)
    sets = ET.fromstring(files.read("rod.pvd")).findall("Collection/DataSet")
    assert [float(one.get("timestep")) for one in sets] == times
    for k, one in enumerate(sets):
        vtp = files.read(one.get("file"))
        assert np.array_equal(array(vtp, "Points", "<f8"), values["r"][k])
        assert np.array_equal(array(vtp, "kappa", "<f8"), values["kappa"][k])
        assert (array(vtp, "radius", "<f8") > 0).all()
    assert len(archive(client, done, "?time_stride=2").namelist()) == 1 + len(times[::2])


def test_vtk_of_many_frames_is_read_in_blocks(settings, client, done, monkeypatch):
    """To unpack a chunk of frames anew for each frame of it took most of the time."""
    [path] = settings.datasets.glob(f"{done}.*.nc")
    reads = []
    monkeypatch.setattr(DatasetSource, "read", lambda source, variable, ranges, read=DatasetSource.read: (
        reads.append(variable.name), read(source, variable, ranges))[1])
    with opened(path) as source:
        frames, radius = len(source.time), np.ones(len(source.s))
        whole = vtk_archive(source, radius)
        assert frames > 4 and reads.count("r") == 1
        monkeypatch.setattr(vtk, "BLOCK", 2 * len(source.s) * 23)  # two frames of all that is stored along the rod
        in_blocks = vtk_archive(source, radius)
        assert reads.count("r") == 1 + math.ceil(frames / 2)
    assert contents(in_blocks) == contents(whole)


def contents(content):
    files = zipfile.ZipFile(io.BytesIO(content))
    return {name: files.read(name) for name in files.namelist()}


def test_vtk_reads_them(client, done, values, tmp_path):
    real = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    archive(client, done).extractall(tmp_path)
    reader = real.vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "frames" / "000003.vtp"))
    reader.Update()
    line = reader.GetOutput()
    assert np.array_equal(vtk_to_numpy(line.GetPoints().GetData()), values["r"][3])
    assert line.GetNumberOfLines() == 1 and line.GetPointData().HasArray("orientation")


def glb(content: bytes):
    assert content[:4] == b"glTF" and int.from_bytes(content[8:12], "little") == len(content)
    size = int.from_bytes(content[12:16], "little")
    return json.loads(content[20 : 20 + size]), content[28 + size :]


def accessor(document, binary, number):
    told = document["accessors"][number]
    view = document["bufferViews"][told["bufferView"]]
    part = binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    values = np.frombuffer(part, "<f4" if told["componentType"] == 5126 else "<u4")
    return values.reshape(told["count"], -1)


def test_gltf_is_a_tube_around_the_centreline_in_each_frame(client, done, values, times):
    document, binary = glb(client.get(f"/v1/jobs/{done}/gltf").content)
    [primitive] = document["meshes"][0]["primitives"]
    first = accessor(document, binary, primitive["attributes"]["POSITION"])
    rings = len(values["r"][0])
    for k in range(len(times)):
        moved = accessor(document, binary, primitive["targets"][k - 1]["POSITION"]) if k else 0.0
        centre = (first + moved).reshape(rings, -1, 3).mean(axis=1)
        assert np.abs(centre - values["r"][k]).max() < 1e-5
    sampler = document["animations"][0]["samplers"][0]
    assert np.allclose(accessor(document, binary, sampler["input"])[:, 0], times)
    weights = accessor(document, binary, sampler["output"]).reshape(len(times), -1)
    assert np.array_equal(weights[1:], np.eye(len(times) - 1)) and not weights[0].any()


def test_trimesh_reads_it(client, done):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load(io.BytesIO(client.get(f"/v1/jobs/{done}/gltf").content), file_type="glb")
    [mesh] = scene.geometry.values()
    assert len(mesh.faces) == 2 * 12 * 8


def test_a_run_that_failed_before_its_first_frame_has_none_to_show(client, registry, settings, case, monkeypatch):
    from worker import attempt
    from worker.run import run_next

    def begin(scene):
        real = simulate(scene)
        real.advance = fail
        return real

    def fail():
        raise RunFailed(Outcome.STEP_TOO_SMALL, 0.0, 0, "stuck")

    monkeypatch.setattr(attempt, "simulate", begin)
    address = client.post("/v1/jobs", json=case).headers["location"]
    run_next(registry.database, settings)
    assert client.get(address).json()["outcome"] == "step_too_small"
    answer = client.get(f"{address}/gltf")
    assert (answer.status_code, answer.json()["type"]) == (404, "urn:hockle:problem:no_frames")
    assert archive(client, address.rpartition("/")[2]).namelist() == ["rod.pvd"]


@pytest.mark.parametrize("what", ["vtk", "gltf"])
def test_what_has_no_shape_is_told(client, registry, settings, case, what):
    from worker.run import run_next

    body = case | {"output": {"interval": 0.01, "fields": ["kappa"]}}
    address = client.post("/v1/jobs", json=body).headers["location"]
    assert client.get(f"{address}/{what}").status_code == 409
    run_next(registry.database, settings)
    answer = client.get(f"{address}/{what}")
    assert (answer.status_code, answer.json()["type"]) == (422, "urn:hockle:problem:unknown_variable")
