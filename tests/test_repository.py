"""What the repository promises beside its code: locks, make targets, packages."""

from __future__ import annotations

import re
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
BESIDE = ("requirements-dev.txt", "requirements-s3.txt", "requirements-deploy.txt", "requirements-docs.txt")


@pytest.mark.parametrize("name", ["requirements.txt", *BESIDE])
def test_a_lock_has_versions_and_hashes_and_no_place(name):
    lines = (ROOT / name).read_text().splitlines()
    pinned = [line for line in lines if line and not line.startswith(" ")]
    assert pinned and all(re.match(r"[a-z0-9._-]+==\S+", line) for line in pinned)
    assert sum(line.startswith("    --hash=sha256:") for line in lines) >= len(pinned)
    assert not re.search(r"https?://|file:|--(extra-)?index|--find-links|(^|\s)/", "\n".join(lines))


@pytest.mark.parametrize("other", BESIDE)
def test_the_locks_agree(other):
    def versions(name: str) -> dict[str, set[str]]:
        found: dict[str, set[str]] = {}
        for package, version in re.findall(r"^([a-z0-9._-]+)==(\S+)", (ROOT / name).read_text(), re.M):
            found.setdefault(package, set()).add(version)
        return found

    runtime, beside = versions("requirements.txt"), versions(other)
    assert [name for name in runtime if name in beside and beside[name] != runtime[name]] == []


@pytest.mark.parametrize("target", ["demo", "test", "serve", "lint", "bench", "validate"])
def test_make_knows_what_the_readme_names(target):
    subprocess.run(["make", "--dry-run", target], cwd=ROOT, check=True, capture_output=True)


def test_the_command_and_the_packages_are_declared():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert project["project"]["scripts"] == {"hockle": "hockle.cli:main"}
    assert project["project"]["requires-python"] == ">=3.11"
