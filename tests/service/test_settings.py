"""Settings: from the environment and back, with clear refusals."""

from __future__ import annotations

from pathlib import Path

import pytest

from service.settings import Settings, from_environment


def test_an_empty_environment_is_enough():
    assert from_environment({}) == Settings()


def test_settings_survive_the_way_to_a_child_process(tmp_path):
    settings = Settings(tmp_path, "redis+socket:///tmp/b.sock", lease=0.7, attempts=2, ring_again=1.25)
    assert from_environment(settings.environment()) == settings


@pytest.mark.parametrize(("url", "kombu"), [
    ("unix:///run/b.sock", "redis+socket:///run/b.sock"),
    ("redis://localhost:6379/0", "redis://localhost:6379/0"),
    ("", ""),
])
def test_redis_urls_are_spelt_for_kombu(url, kombu):
    assert from_environment({"REDIS_URL": url}).broker == kombu


@pytest.mark.parametrize(("environment", "message"), [
    ({"HOCKLE_LEASE": "long"}, "HOCKLE_LEASE must be a number, got 'long'"),
    ({"HOCKLE_LEASE": "-1"}, "lease must be > 0, got -1.0"),
    ({"REDIS_URL": "amqp://x"}, "REDIS_URL must be redis://"),
])
def test_a_refusal_names_the_setting_the_value_and_the_rule(environment, message):
    with pytest.raises(ValueError, match=message):
        from_environment(environment)


def test_directories_are_for_this_user_only(tmp_path):
    settings = Settings(Path(tmp_path / "var"))
    settings.make_directories()
    assert settings.data.stat().st_mode & 0o077 == 0
