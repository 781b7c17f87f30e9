"""The client and a real service: submit, follow, list, cancel, read."""

from __future__ import annotations

import tempfile
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
import xarray as xr

from hockle_client import Case, HockleError, Problem, case_of
from service.cases import load_case, parse_case

APIS = 2

@pytest.fixture
def done(client, quick):
    return client.submit(quick, label="done").wait()


def test_a_shipped_case_is_changed_run_and_read(client, quick, capsys):
    job = client.submit(quick, set={"t_end": 0.2}, label="first").wait(progress=True)
    assert (job.status, job.outcome, job.label, job.progress) == ("successful", "completed", "first", 1.0)
    told = capsys.readouterr()
    assert "successful 100%" in told.err.splitlines()[-1] and not told.out
    with job.dataset() as dataset:
        assert dataset.time.values == pytest.approx([0.0, 0.1, 0.2])
        assert case_of(dataset) == job.case()
        assert parse_case(case_of(dataset)).t_end == 0.2


def test_what_has_run_before_is_the_answer_unless_it_is_to_run_again(client, quick, done):
    assert client.submit(quick).id == done.id
    assert client.submit(quick, again=True).id != done.id


def test_a_submission_with_the_key_of_another_is_that_one(client, quick, slow):
    first = client.submit(quick, again=True, idempotency_key="once-" + quick.settings["description"])
    second = client.submit(quick, again=True, idempotency_key="once-" + quick.settings["description"])
    assert first.id == second.id


def test_numbers_of_numpy_are_numbers(client, quick):
    changed = quick.set("t_end", np.float64(0.2)).set("numerics.intervals", np.int64(21))
    verdict = client.validate(changed.set("loads.gravity", np.array([0.0, 0.0, -9.81])))
    assert verdict.case["numerics"]["intervals"] == 21
    assert verdict.case["loads"]["gravity"] == [0.0, 0.0, -9.81]


@pytest.mark.parametrize(("value", "told"), [
    (float("nan"), "/set/loads.gravity/2 must be a finite number, got NaN"),
    (np.float64("inf"), "/set/loads.gravity/2 must be a finite number, got Infinity"),
])  # fmt: skip
def test_a_number_that_is_not_finite_is_told_where_it_stands(client, value, told):
    with pytest.raises(ValueError, match=told):
        client.submit("elastica", set={"loads.gravity": [0.0, 0.0, value]})


def test_a_whole_case_may_be_data_or_a_file(client, tmp_path):
    import json

    case = load_case("elastica")
    (tmp_path / "case.json").write_text(json.dumps(case))
    verdicts = [client.validate(one) for one in ("elastica", case, Case.of(case), Case.load(tmp_path / "case.json"))]
    assert all(verdict == verdicts[0] for verdict in verdicts)
    assert client.cost("elastica") == verdicts[0].cost and verdicts[0].cost.seconds > 0


def test_the_shipped_cases_are_told(client):
    assert client.shipped()["goyal-2003"]
    assert client.shipped_case("elastica") == load_case("elastica")


def test_a_faulty_case_is_refused_with_what_is_wrong(client):
    with pytest.raises(Problem) as refused:
        client.submit("goyal-2003", set={"t_end": -1, "numerics.intervalls": 3})
    problem = refused.value
    assert (problem.status, problem.name, problem.type) == (422, "invalid_case", "urn:hockle:problem:invalid_case")
    assert {(fault.place, fault.value) for fault in problem.errors} == {("/t_end", -1), ("/numerics/intervalls", 3)}
    assert "/t_end must be > 0, got -1" in str(problem)
    assert "/numerics/intervalls is not a known field, got 3: did you mean intervals?" in map(str, problem.errors)
    assert problem.document["detail"] == problem.detail and not problem.temporary


def test_a_job_that_is_not_there_is_told(client):
    with pytest.raises(Problem, match="there is no job 'nobody'") as refused:
        client.job("nobody")
    assert (refused.value.status, refused.value.name) == (404, "unknown_job")
    with pytest.raises(HockleError, match="letters and digits"):
        client.job("../cases")


def test_lists_hold_what_is_asked_for_over_all_pages(client, quick, capsys):
    made = [client.submit(quick.set("t_end", 0.1 + 0.01 * i), label="many").id for i in range(5)]
    waited = client.wait([client.job(job_id) for job_id in made], progress=True)
    assert capsys.readouterr().err.splitlines()[-1].startswith("5 of 5 jobs have ended, ")
    assert [job.status for job in waited] == ["successful"] * 5
    assert [job.id for job in client.jobs(label="many", status="successful")][:5] == made[::-1]
    assert list(client.jobs(label="nothing")) == []
    now = datetime.now(UTC)
    assert [job.id for job in client.jobs(label="many", since=now - timedelta(hours=1))][:5] == made[::-1]
    assert list(client.jobs(since=now + timedelta(hours=1))) == []
    assert [job.id for job in client.jobs(label="many", until=client.job(made[1]).state.created)][:1] == made[:1]


def test_a_job_is_cancelled(client, slow):
    job = client.submit(slow)
    assert job.cancel().wait(timeout=60).status == "dismissed"
    with pytest.raises(Problem) as refused:
        job.dataset()
    assert refused.value.name == "no_dataset"


def test_a_job_is_pinned_and_deleted(client, quick, slow):
    job = client.submit(quick).wait()
    assert job.pin().state.pinned
    with pytest.raises(Problem, match="is pinned: unpin it"):
        job.delete()
    assert not job.unpin().state.pinned
    job.delete()
    with pytest.raises(Problem, match=f"job {job.id} was deleted by local at") as gone:
        job.refresh()
    assert (gone.value.status, gone.value.name) == (410, "job_deleted")
    running = client.submit(slow)
    with pytest.raises(HockleError, match="cancel it, and wait for its end"):
        running.delete()
    running.cancel()


def test_waiting_has_an_end(client, slow):
    job = client.submit(slow)
    with pytest.raises(TimeoutError, match=f"job {job.id} has not ended within 0.2 s"):
        job.wait(timeout=0.2)
    with pytest.raises(Problem) as refused:
        client_without_patience(client).job(job.id).values("Tw")
    assert (refused.value.status, refused.value.name) == (409, "not_finished")
    job.cancel()


def client_without_patience(client):
    getattr(client, "inner", client).patience = 0.0
    return client


def test_events_are_told_as_they_happen(client, quick):
    job = client.submit(quick)
    events = list(job.events())
    kinds = [event.kind for event in events]
    assert kinds[0] == "accepted" and kinds[-1] == "ended" and "started" in kinds
    assert [event.id for event in events] == sorted({event.id for event in events})
    assert list(job.events(after=events[-1].id)) == []
    assert [event.kind for event in job.events(after=events[-2].id)] == ["ended"]
    *_, last = job.watch()
    assert (last.id, last.status) == (job.id, "successful")


def test_parts_are_read_without_the_file(client, done, tmp_path):
    done.fetch(tmp_path / "whole.nc")
    with xr.open_dataset(tmp_path / "whole.nc", decode_times=False) as whole:
        part = done.data("Tw", "r", t_min=0.1, s_stride=10)
        xr.testing.assert_equal(part, whole[["Tw", "r"]].sel(time=slice(0.1, None)).isel(s=slice(None, None, 10))
                                .drop_vars([]))  # fmt: skip
        assert part.r.attrs["units"] == "m"
        table = done.table("Tw", "Wr")
        assert table.index.name == "time" and table.Tw.tolist() == whole.Tw.values.tolist()
        assert done.values("Lk", time_stride=3)["variables"]["Lk"]["values"] == whole.Lk.values[::3].tolist()
        [record] = client.scalars([done.id], "Tw", "contacts")
        assert record == {"id": done.id, "label": "done", "status": "successful", "outcome": "completed", "t": 0.3,
                          "Tw": float(whole.Tw[-1]), "contacts": int(whole.contacts[-1])}
    assert list(tmp_path.iterdir()) == [tmp_path / "whole.nc"]


def test_an_opened_dataset_leaves_no_file(done, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with done.dataset() as dataset:
        assert list(tmp_path.iterdir()) == [] and dataset.r.values.shape[-1] == 3


def test_a_dataset_that_cannot_be_written_leaves_nothing(client, done, tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        done.fetch(tmp_path / "nowhere" / "x.nc")
    (tmp_path / "taken").mkdir()
    with pytest.raises(OSError, match="taken"):
        done.fetch(tmp_path / "taken")
    assert list(tmp_path.iterdir()) == [tmp_path / "taken"]


def test_a_link_is_read_by_xarray_where_it_is(client, done):
    link = done.link(seconds=np.float64(60.0))
    with xr.open_dataset(f"{link.url}#mode=bytes") as dataset, done.dataset() as whole:
        assert dataset.r.values.tolist() == whole.r.values.tolist()
    [listed] = done.links()
    assert (listed.id, listed.url, listed.revoked) == (link.id, "", None)
    done.revoke(link)
    assert done.links()[0].revoked is not None
    with pytest.raises(OSError):
        xr.open_dataset(f"{link.url}#mode=bytes")


def test_a_server_that_tells_no_address_of_a_zarr_store_is_understood(done):
    told = {"id": "a", "href": "/v1/shared/x.nc", "created": "2026-01-01T00:00:00Z", "expires": "2026-01-02T00:00:00Z"}
    link = getattr(done, "inner", done)._linked({**told, "revoked": None})
    assert link.url.endswith("/v1/shared/x.nc") and (link.zarr, link.opendap) == ("", "")


def test_a_job_goes_on_beyond_its_end_and_is_forked(client, quick):
    job = client.submit(quick.set("numerics.method", "staggered")).wait()
    longer, fork = job.again(set={"t_end": 0.5}, label="longer"), job.fork(0.25, end={"omega3": 0.0})
    assert longer.wait().case()["t_end"] == 0.5 and longer.label == "longer"
    assert fork.wait().case()["ends"]["end"]["switches"][-1] == {"at": 0.25, "omega3": 0.0}
    assert (longer.status, fork.status) == ("successful", "successful")
    assert longer.values("Tw")["variables"]["Tw"]["values"][:3] == job.values("Tw")["variables"]["Tw"]["values"][:3]


def test_the_moving_rod_is_written_for_other_programs(client, quick, tmp_path):
    job = client.submit(quick).wait()
    assert job.export(tmp_path / "run.glb") == (tmp_path / "run.glb").stat().st_size
    assert (tmp_path / "run.glb").read_bytes()[:4] == b"glTF"
    job.export(tmp_path / "run.zip")
    assert (tmp_path / "run.zip").read_bytes()[:2] == b"PK"
    with pytest.raises(HockleError, match=r"must end in \.glb or \.zip"):
        job.export(tmp_path / "run.obj")
