"""Settings: from the environment and back, with clear refusals."""

from __future__ import annotations

from pathlib import Path

import pytest

from service.settings import Settings, from_environment


def test_an_empty_environment_is_enough():
    assert from_environment({}) == Settings()


def test_settings_survive_the_way_to_a_child_process(tmp_path):
    told = Settings(tmp_path, "postgresql://h/x", "redis+socket:///tmp/b.sock", tmp_path / "shared", lease=0.7,
                    attempts=2, checkpoint=1.25, objects="s3://bucket/prefix")
    assert from_environment(told.environment()) == told
    assert from_environment(Settings(tmp_path).environment()) == Settings(tmp_path)


def test_one_file_tells_all_and_the_environment_is_stronger(tmp_path):
    file = tmp_path / "hockle.toml"
    file.write_text('database = "postgresql://db/hockle"\nlease = 12\nattempts = 5\n')
    told = from_environment({"HOCKLE_SETTINGS": str(file), "HOCKLE_ATTEMPTS": "4"})
    assert (told.database_url, told.lease, told.attempts) == ("postgresql+psycopg://db/hockle", 12.0, 4)


def test_without_a_database_there_is_one_in_the_data_directory(tmp_path):
    assert Settings(tmp_path).database_url == f"sqlite:///{tmp_path}/registry.db"


def test_an_unknown_setting_in_the_file_is_refused(tmp_path):
    file = tmp_path / "hockle.toml"
    file.write_text("leese = 12\n")
    with pytest.raises(ValueError, match="leese"):
        from_environment({"HOCKLE_SETTINGS": str(file)})


def test_no_password_is_told_of_a_setting_that_was_misspelt(tmp_path):
    file = tmp_path / "hockle.toml"
    file.write_text('databse = "postgresql://me:secret@x/y"\n')
    with pytest.raises(ValueError, match="databse") as refusal:
        from_environment({"HOCKLE_SETTINGS": str(file)})
    assert "secret" not in str(refusal.value)


@pytest.mark.parametrize(("url", "kombu"), [
    ("unix:///run/b.sock", "redis+socket:///run/b.sock"),
    ("redis://localhost:6379/0", "redis://localhost:6379/0"),
    ("", ""),
])
def test_redis_urls_are_spelt_for_kombu(url, kombu):
    assert from_environment({"REDIS_URL": url}).broker == kombu


@pytest.mark.parametrize(("environment", "message"), [
    ({"HOCKLE_LEASE": "long"}, "HOCKLE_LEASE: Input should be a valid number.*got 'long'"),
    ({"HOCKLE_LEASE": "-1"}, "HOCKLE_LEASE: Input should be greater than 0, got '-1'"),
    ({"HOCKLE_DATABASE": "mysql://me:secret@x/y"}, "HOCKLE_DATABASE: .*must be postgresql:// or sqlite://"),
    ({"HOCKLE_OBJECTS": "gs://x"}, "HOCKLE_OBJECTS: .*must be s3://bucket or s3://bucket/prefix, got 'gs://x'"),
    ({"REDIS_URL": "amqp://x"}, "REDIS_URL: .*must be redis://"),
])
def test_a_refusal_names_the_setting_the_value_and_the_rule(environment, message):
    with pytest.raises(ValueError, match=message):
        from_environment(environment)


def test_directories_are_for_this_user_only(tmp_path):
    settings = Settings(Path(tmp_path / "var"))
    settings.make_directories()
    assert settings.data.stat().st_mode & 0o077 == 0


def test_an_object_store_needs_its_library(monkeypatch):
    monkeypatch.setattr("service.settings.find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"HOCKLE_OBJECTS: .*install hockle\[s3\]"):
        from_environment({"HOCKLE_OBJECTS": "s3://bucket"})
