"""One job in a registry and directories of its own. A module may have another `case`, or other `settings`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from service.cases import apply_settings, load_case
from service.jobs import Database, Job, NewJob, Registry
from service.jobs.reconciler import beats, take_back
from service.settings import Settings


@pytest.fixture
def case() -> dict[str, Any]:
    changed = {"t_end": 0.05, "output.interval": 0.01, "numerics.intervals": 8}
    return apply_settings(load_case("cantilever-vibration"), changed)


@pytest.fixture
def settings(tmp_path: Path, tables: None) -> Settings:
    made = Settings(tmp_path, lease=1000.0)
    made.make_directories()
    return made


@pytest.fixture
def registry(settings: Settings) -> Iterator[Registry]:
    database = Database(settings.database_url)
    yield Registry(database)
    database.close()


@pytest.fixture
def job(registry: Registry, case: dict[str, Any]) -> Job:
    return registry.submit(NewJob(case))


@pytest.fixture
def take_back_all(registry: Registry) -> Callable[[], None]:
    """Take back the jobs of all workers, as if each had fallen silent."""

    def take() -> None:
        for beat in beats(registry.database):
            take_back(registry.database, beat, 3)

    return take
