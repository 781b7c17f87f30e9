"""The interface over a registry of its own, without a broker and without workers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.api.app import create_app
from service.cases import apply_settings, load_case
from service.jobs import Registry
from service.settings import Settings
from worker.run import run_next

SMALL = {"t_end": 0.05, "output.interval": 0.01, "numerics.intervals": 8}


@pytest.fixture
def settings(tmp_path: Path, tables: None) -> Settings:
    return Settings(data=tmp_path)


@pytest.fixture
def client(settings: Settings) -> Iterator[TestClient]:
    app = create_app(settings)
    with TestClient(app, base_url="http://127.0.0.1:8000", raise_server_exceptions=False) as client:
        yield client


@pytest.fixture
def registry(client: TestClient) -> Registry:
    return client.app.state.parts.registry


@pytest.fixture
def case() -> dict[str, Any]:
    return apply_settings(load_case("cantilever-vibration"), SMALL)


@pytest.fixture
def done(client: TestClient, registry: Registry, settings: Settings, case: dict[str, Any]) -> str:
    """The id of a job that has been run."""
    job_id = client.post("/v1/jobs", json=case).json()["id"]
    run_next(registry.database, settings)
    return job_id
