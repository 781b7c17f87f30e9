"""submit, status, fetch, jobs, cancel, watch, sweep: what they print, and what they say when they cannot."""

from __future__ import annotations

import json

import pytest

from hockle.cli import main

NOWHERE = "http://127.0.0.1:9"


@pytest.fixture(autouse=True)
def _server(server, monkeypatch):
    monkeypatch.setenv("HOCKLE_SERVER", server.address)


@pytest.fixture
def case_file(quick, tmp_path):
    path = tmp_path / "case.json"
    path.write_text(json.dumps(quick))
    return str(path)


def test_a_case_is_submitted_followed_and_fetched(case_file, tmp_path, capsys):
    assert main(["submit", case_file, "--set", "t_end=0.3", "--wait"]) == 0
    job_id, sentence = capsys.readouterr().out.splitlines()
    assert sentence == f"{job_id}: successful"
    assert main(["status", job_id]) == 0
    assert capsys.readouterr().out.strip() == sentence
    assert main(["status", job_id, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["t"] == pytest.approx(0.3)
    assert main(["fetch", job_id, "-o", str(tmp_path / "out.nc")]) == 0
    assert (tmp_path / "out.nc").read_bytes()[:4] == b"\x89HDF"


def refusal(capsys, *arguments: str) -> str:
    assert main(list(arguments)) == 1
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("hockle: ")
    return told.err


def test_an_unknown_job_is_told_so(capsys, tmp_path):
    assert "there is no job 'nobody'" in refusal(capsys, "status", "nobody")
    assert "there is no job 'nobody'" in refusal(capsys, "fetch", "nobody", "-o", str(tmp_path / "x.nc"))
    assert list(tmp_path.iterdir()) == []


def test_an_id_that_is_none_is_not_sent(capsys):
    assert "letters and digits only" in refusal(capsys, "status", "../cases")


def test_a_server_that_is_not_there_is_told_with_the_remedy(capsys, case_file):
    for command in (["status", "x"], ["submit", case_file], ["fetch", "x"]):
        told = refusal(capsys, *command, "--server", NOWHERE)
        assert f"no hockle server answers at {NOWHERE}" in told and "hockle serve" in told


def test_a_job_that_has_not_ended_cannot_be_fetched_yet(capsys, slow, tmp_path):
    (tmp_path / "slow.json").write_text(json.dumps(slow))
    assert main(["submit", str(tmp_path / "slow.json")]) == 0
    job_id = capsys.readouterr().out.strip()
    assert "its dataset comes at its end" in refusal(capsys, "fetch", job_id, "-o", str(tmp_path / "x.nc"))
    assert not (tmp_path / "x.nc").exists()
    assert main(["cancel", job_id]) == 0


def test_a_faulty_case_is_refused_by_field_value_and_rule(capsys, case_file):
    told = refusal(capsys, "submit", case_file, "--set", "t_end=-1")
    assert "/t_end must be > 0" in told and "got -1" in told


def test_a_case_that_is_not_there_is_told_so(capsys):
    assert "goyal-2003" in refusal(capsys, "submit", "goyal-2004")


def test_a_setting_without_a_value_is_told_so(capsys, case_file):
    assert "--set takes KEY=VALUE" in refusal(capsys, "submit", case_file, "--set", "t_end")


def test_a_dataset_that_cannot_be_written_is_told_so(capsys, case_file, tmp_path):
    assert main(["submit", case_file, "--wait"]) == 0
    job_id = capsys.readouterr().out.split()[0]
    assert "cannot write" in refusal(capsys, "fetch", job_id, "-o", str(tmp_path / "none" / "x.nc"))


def test_jobs_are_listed_newest_first_by_status_and_label(case_file, capsys):
    for t_end in ("0.2", "0.3"):
        assert main(["submit", case_file, "--set", f"t_end={t_end}", "--label", "listed", "--wait"]) == 0
    made = [line.split(":")[0] for line in capsys.readouterr().out.splitlines() if "successful" in line]
    assert main(["jobs", "--label", "listed", "--status", "successful"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in lines] == [[job_id, "successful", "100%"] for job_id in made[::-1]]
    assert main(["jobs", "--label", "listed", "-n", "1"]) == 0
    assert capsys.readouterr().out.splitlines() == lines[:1]
    assert main(["jobs", "--label", "nothing"]) == 0
    assert capsys.readouterr().out == ""


def test_jobs_are_listed_from_a_time_on_and_before_another(case_file, capsys):
    assert main(["submit", case_file, "--label", "timed"]) == 0
    job_id = capsys.readouterr().out.strip()
    assert main(["status", job_id, "--json"]) == 0
    created = json.loads(capsys.readouterr().out)["created"]
    for options, listed in ((["--since", created], True), (["--until", created], False),
                            (["--since", "2000-01-01", "--until", "2999-01-01T12:00"], True),
                            (["--until", "2000-01-01"], False)):  # fmt: skip
        assert main(["jobs", "--label", "timed", *options]) == 0
        assert capsys.readouterr().out.startswith(job_id) == listed
    with pytest.raises(SystemExit):
        main(["jobs", "--since", "yesterday"])
    assert "argument --since: invalid time value: 'yesterday'" in capsys.readouterr().err


def test_a_job_is_watched_and_cancelled(slow, quick, tmp_path, capsys):
    ids = []
    for case in (slow, quick):
        (tmp_path / "case.json").write_text(json.dumps(case))
        assert main(["submit", str(tmp_path / "case.json")]) == 0
        ids.append(capsys.readouterr().out.strip())
    assert main(["cancel", ids[0]]) == 0
    assert capsys.readouterr().out.startswith(f"{ids[0]}: ")
    assert main(["watch", ids[1]]) == 0
    assert capsys.readouterr().out == f"{ids[1]}: successful\n"
    assert main(["watch", ids[0]]) == 1
    assert f"{ids[0]}: dismissed" in capsys.readouterr().out


def test_a_job_is_pinned_unpinned_and_deleted(quick, tmp_path, capsys):
    (tmp_path / "case.json").write_text(json.dumps(quick))
    assert main(["submit", str(tmp_path / "case.json"), "--wait"]) == 0
    job_id = capsys.readouterr().out.split()[0].rstrip(":")
    assert main(["pin", job_id]) == 0
    assert f"job {job_id} is pinned" in refusal(capsys, "delete", job_id)
    assert main(["unpin", job_id]) == main(["delete", job_id]) == 0
    assert f"job {job_id} was deleted by local" in refusal(capsys, "status", job_id)


@pytest.mark.parametrize("command", [["cancel", "nobody"], ["watch", "nobody"]])
def test_what_is_not_there_is_neither_cancelled_nor_watched(capsys, command):
    assert "there is no job 'nobody'" in refusal(capsys, *command)


def test_a_sweep_is_handed_in_and_its_numbers_come_as_csv(case_file, tmp_path, capsys):
    table = tmp_path / "table.csv"
    assert main(["sweep", case_file, "loads.damping=0,0.5", "t_end=0.1,0.2", "--scalars", "Tw", "-o", str(table)]) == 0
    head, *rows = table.read_text().splitlines()
    assert head == "member,loads.damping,t_end,id,label,status,outcome,t,Tw" and len(rows) == 4
    assert rows[3].startswith("3,0.5,0.2,") and ",successful,completed,0.2," in rows[3]
    sample = ["--sample", "sobol", "--size", "2", "--set", "t_end=0.1"]
    assert main(["sweep", case_file, "loads.damping=0:1", *sample]) == 0
    assert len(capsys.readouterr().out.strip()) == 26


@pytest.mark.parametrize(("varied", "told"), [("loads.damping", "must have both"), ("loads.damping=a,b", "numbers"),
                                              ("loads.damping=0:x", "LOW:HIGH"), ("loads.damping=-1", "member 0")])
def test_a_sweep_that_cannot_be_run_is_told_so(case_file, capsys, varied, told):
    assert told in refusal(capsys, "sweep", case_file, varied)


@pytest.mark.parametrize(("option", "told"), [
    (["--scalars", "Tw,r"], "--scalars: variable must be one of"),
    (["--sample", "sobol"], "--sample sobol needs --size"),
])
def test_a_sweep_is_refused_before_anything_is_run(case_file, capsys, option, told):
    assert told in refusal(capsys, "sweep", case_file, "loads.damping=0,0.25", "--label", "refused", *option)
    assert main(["jobs", "--label", "refused"]) == 0
    assert capsys.readouterr().out == ""


def test_a_job_is_run_again_with_a_change(case_file, capsys):
    assert main(["submit", case_file, "--set", "t_end=0.3", "--wait"]) == 0
    job_id = capsys.readouterr().out.split()[0]
    assert main(["again", job_id, "--set", "t_end=0.4", "--label", "longer", "--wait"]) == 0
    other = capsys.readouterr().out.split()[0]
    assert main(["status", other, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["t"], told["label"]) == (pytest.approx(0.4), "longer")
    assert main(["again", job_id, "--at", "0.15", "--end", "omega3=0"]) == 0
    assert capsys.readouterr().out.strip() not in (job_id, other)
    assert "is required" in refusal(capsys, "again", job_id, "--at", "0.15")
