"""docker-compose.yml: what it opens, what it allows, and what the rehearsal reads in it."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from deploy.rehearse.compose import services
from hockle.cli import parser
from service.settings import Settings

FILE = Path(__file__).parents[2] / "docker-compose.yml"
SECRETS = {"POSTGRES_PASSWORD": "p", "REDIS_PASSWORD": "r"}


@pytest.fixture(scope="module")
def told():
    return services(FILE, SECRETS)


@pytest.fixture(scope="module")
def written():
    return yaml.safe_load(FILE.read_text())


def test_only_the_api_is_reached_and_only_from_its_host(written):
    assert set(written["services"]) == {"api", "worker", "redis", "postgres"}
    assert {name: one["ports"] for name, one in written["services"].items() if "ports" in one} == \
        {"api": ["127.0.0.1:8000:8000"]}  # fmt: skip
    assert written["networks"]["inside"] == {"internal": True}
    assert [name for name, one in written["services"].items() if "outside" in one["networks"]] == ["api"]


@pytest.mark.parametrize("name", ["api", "worker"])
def test_what_is_ours_may_do_little_and_runs_a_command_that_exists(told, name):
    one = told[name]
    assert one.read_only and one.no_capabilities and one.no_new_privileges and one.tmpfs == ["/tmp"]
    assert one.command[0] == "hockle" and parser().parse_args(one.command[1:])
    assert set(one.environment) <= set(Settings().environment())
    assert set(one.mounts.values()) == {one.environment["HOCKLE_DATA"], one.environment["HOCKLE_STORE"]}


def test_a_worker_has_longer_than_a_checkpoint_to_hand_its_jobs_back(told):
    assert told["worker"].stop_signal == "SIGQUIT"
    assert told["worker"].grace > 2 * Settings().checkpoint


@pytest.mark.parametrize("missing", SECRETS)
def test_no_secret_has_a_default(missing):
    with pytest.raises(ValueError, match=f"{missing} must be set"):
        services(FILE, {name: value for name, value in SECRETS.items() if name != missing})


def test_what_the_rehearsal_would_pass_over_is_refused(tmp_path):
    strange = tmp_path / "compose.yml"
    strange.write_text("services: {api: {privileged: true}}")
    with pytest.raises(ValueError, match="service api: the rehearsal does not follow privileged"):
        services(strange, {})
