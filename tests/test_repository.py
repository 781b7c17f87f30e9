"""What the repository promises beside its code: locks, containers, make targets."""

from __future__ import annotations

import re
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parent.parent


@pytest.mark.parametrize("name", ["requirements.txt", "requirements-dev.txt", "requirements-s3.txt"])
def test_a_lock_has_versions_and_hashes_and_no_place(name):
    lines = (ROOT / name).read_text().splitlines()
    pinned = [line for line in lines if line and not line.startswith(" ")]
    assert pinned and all(re.match(r"[a-z0-9._-]+==\S+", line) for line in pinned)
    assert sum(line.startswith("    --hash=sha256:") for line in lines) >= len(pinned)
    assert not re.search(r"https?://|file:|--(extra-)?index|--find-links|(^|\s)/", "\n".join(lines))


@pytest.mark.parametrize("other", ["requirements-dev.txt", "requirements-s3.txt"])
def test_the_locks_agree(other):
    def versions(name: str) -> dict[str, set[str]]:
        found: dict[str, set[str]] = {}
        for package, version in re.findall(r"^([a-z0-9._-]+)==(\S+)", (ROOT / name).read_text(), re.M):
            found.setdefault(package, set()).add(version)
        return found

    runtime, beside = versions("requirements.txt"), versions(other)
    assert [name for name in runtime if name in beside and beside[name] != runtime[name]] == []


def test_no_container_is_reached_from_the_network():
    services = yaml.safe_load((ROOT / "docker-compose.yml").read_text())["services"]
    assert set(services) == {"api", "worker", "redis"}
    assert not any("ports" in service for service in services.values())
    assert services["worker"]["network_mode"] == services["redis"]["network_mode"] == "none"
    for part in ("api", "worker"):
        assert services[part]["volumes"] == ["data:/data", "broker:/broker"]
        assert services[part]["depends_on"]["redis"]["condition"] == "service_healthy"


def test_containers_are_told_only_settings_that_exist():
    from service.settings import Settings

    services = yaml.safe_load((ROOT / "docker-compose.yml").read_text())["services"]
    assert set(services["api"]["environment"]) <= set(Settings().environment())


@pytest.mark.parametrize("target", ["demo", "test", "serve", "lint", "bench", "validate"])
def test_make_knows_what_the_readme_names(target):
    subprocess.run(["make", "--dry-run", target], cwd=ROOT, check=True, capture_output=True)


def test_the_command_and_the_packages_are_declared():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert project["project"]["scripts"] == {"hockle": "hockle.cli:main"}
    assert project["project"]["requires-python"] == ">=3.11"
