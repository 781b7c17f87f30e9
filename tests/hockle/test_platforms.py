"""Where Python lacks what Unix has, a command works or refuses with a sentence."""

from __future__ import annotations

import subprocess
import sys

import pytest

WITHOUT = """
import sys
sys.modules.update(fcntl=None, resource=None)
from hockle.cli import main
sys.exit(main(sys.argv[1:]))
"""


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """A command where `import fcntl` fails, as on Windows."""
    return subprocess.run([sys.executable, "-c", WITHOUT, *arguments], capture_output=True, text=True)


@pytest.mark.parametrize("arguments", [["cases"], ["validate", "elastica"], ["--help"]])
def test_what_needs_no_unix_works(arguments):
    ended = run(*arguments)
    assert (ended.returncode, ended.stderr) == (0, "")


def test_what_talks_to_a_server_works():
    ended = run("status", "--server", "http://127.0.0.1:9", "some")
    assert ended.returncode == 1
    assert ended.stderr.startswith("hockle: ") and "Windows" not in ended.stderr


@pytest.mark.parametrize("arguments", [["run", "elastica"], ["serve"], ["api"], ["worker"]])
def test_what_needs_unix_refuses_with_one_sentence(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ended = run(*arguments)
    assert ended.returncode == 1
    assert ended.stderr.startswith("hockle: this command needs Linux or macOS")
    assert ended.stderr.count("\n") == 1 and list(tmp_path.iterdir()) == []
