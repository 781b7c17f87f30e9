"""Whoever starts the service with something wrong reads one line on each fault: the setting, its value, the rule."""

from __future__ import annotations

import errno
import os
import re
import stat
import subprocess
import sys

import pytest

from hockle.broker import short_directory
from hockle.cli import main

BAD_FILE = "lease = = 3\n"


def refusal(capsys, *command: str) -> str:
    assert main(list(command)) == 1
    told = capsys.readouterr().err
    assert "Traceback" not in told
    return told.removeprefix("hockle: ").rstrip("\n")


@pytest.mark.parametrize(("environment", "lines"), [
    ({"HOCKLE_LEASE": "soon"}, ["HOCKLE_LEASE: .*valid number.*got 'soon'"]),
    ({"HOCKLE_LEASE": "-1", "HOCKLE_QUOTA": "many"}, ["HOCKLE_LEASE: .*greater than 0, got '-1'",
                                                      "HOCKLE_QUOTA: .*integer.*got 'many'"]),
    ({"HOCKLE_DATABASE": "postgresql://host:port/name"}, ["HOCKLE_DATABASE: "]),
    ({"HOCKLE_DATABASE": "postgresql://host"}, ["HOCKLE_DATABASE: must name a database"]),
    ({"HOCKLE_DATABASE": "sqlite://"}, ["HOCKLE_DATABASE: must name a database"]),
    ({"REDIS_URL": "redis://h:99999/0"}, ["REDIS_URL: Port out of range"]),
    ({"HOCKLE_SETTINGS": "/nowhere/at/all"}, ["HOCKLE_SETTINGS: must name a file that can be read, got '/nowhere"]),
    ({"HOCKLE_KEEP_DAYS": "0"}, ["HOCKLE_KEEP_DAYS: .*greater than 0, got '0'"]),
])  # fmt: skip
@pytest.mark.parametrize("command", [["serve"], ["worker"], ["api"], ["keys", "list"], ["store", "check"]])
def test_a_wrong_setting_is_one_line(environment, lines, command, monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("HOCKLE_DATA", str(tmp_path))
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    told = refusal(capsys, *command).splitlines()
    assert len(told) == len(lines)
    assert all(re.match(line, one) for line, one in zip(lines, told, strict=True)), told


def test_a_settings_file_that_is_not_toml_is_one_line(monkeypatch, tmp_path, capsys):
    (tmp_path / "hockle.toml").write_text(BAD_FILE)
    monkeypatch.setenv("HOCKLE_SETTINGS", str(tmp_path / "hockle.toml"))
    [line] = refusal(capsys, "serve").splitlines()
    assert line.startswith("HOCKLE_SETTINGS: must name a file in TOML, got '")


def test_celery_says_which_setting_is_wrong(tmp_path):
    command = [sys.executable, "-m", "celery", "--app", "worker.app", "worker"]
    environment = {**os.environ, "HOCKLE_LEASE": "soon"}
    told = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    assert told.returncode != 0 and "Traceback" not in told.stderr
    assert "HOCKLE_LEASE: Input should be a valid number" in told.stderr


@pytest.mark.parametrize("command", [["serve"], ["keys", "list"], ["store", "check"]])
def test_a_data_directory_that_is_a_file_is_named(command, tmp_path, capsys):
    (tmp_path / "data").write_text("")
    told = refusal(capsys, *command, "--data", str(tmp_path / "data"))
    assert told.splitlines() == [f"the directory {tmp_path / 'data'} cannot be used: File exists"]


@pytest.mark.parametrize("words", [["--port", "99999"], ["--port", "http"], ["--workers", "0"], ["--workers", "-1"]])
def test_a_number_out_of_range_is_one_line(words, capsys):
    with pytest.raises(SystemExit):
        main(["serve", *words])
    assert "must be a whole number from" in capsys.readouterr().err.splitlines()[-1]


def test_a_database_that_is_away_is_one_line(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("HOCKLE_DATABASE", "postgresql://127.0.0.1:9/none")
    [line, *_] = told = refusal(capsys, "serve", "--data", str(tmp_path)).splitlines()
    assert line.startswith("the registry cannot be opened: ") and len(told) == 1


def test_a_directory_that_somebody_made_for_all_is_closed(tmp_path, capsys):
    data = tmp_path / "data"
    data.mkdir()
    data.chmod(0o755)
    assert main(["keys", "create", "alice", "--data", str(data)]) == 0
    assert stat.S_IMODE(data.stat().st_mode) == 0o700
    modes = {path.name: stat.S_IMODE(path.stat().st_mode) & 0o077 for path in data.rglob("*")}
    assert modes and not any(modes.values()), modes


def test_a_full_disk_is_one_line_and_leaves_no_folder_behind(monkeypatch, tmp_path, capsys):
    """Found by `make attack`: started while the disk was full, it gave a traceback, and left a folder each time."""

    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    monkeypatch.setattr("pathlib.Path.write_text", full)
    with pytest.raises(OSError, match="No space left"):
        short_directory(tmp_path / "broker").__enter__()
    assert list((tmp_path / "tmp").iterdir()) == []
    monkeypatch.setattr("hockle.serving.settings_of", full)
    assert refusal(capsys, "serve") == "there is no room left for what it writes: No space left on device"
