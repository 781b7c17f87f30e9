"""The rehearsal says what it needs before it begins."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from deploy.rehearse import needed

ROOT = Path(__file__).parents[2]


def test_the_packages_that_it_lacks_are_named(monkeypatch):
    monkeypatch.setattr(needed.shutil, "which", lambda program, path: None if program == "buildah" else program)
    monkeypatch.setattr(needed, "binaries", lambda: None)
    monkeypatch.setattr(needed.os, "geteuid", lambda: 0)
    assert needed.missing() == ["apt-get install --no-install-recommends buildah postgresql"]


def test_without_them_nothing_is_begun(tmp_path):
    code = ("import sys; from deploy.rehearse import needed, __main__ as main; needed.PATH = ''; "
            "sys.argv = ['rehearse', '--keep', sys.argv[1]]; main.main()")  # fmt: skip
    command = [sys.executable, "-c", code, str(tmp_path / "kept")]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert ended.returncode == 1 and "buildah debootstrap redis-server" in ended.stderr
    assert not (tmp_path / "kept").exists()
