"""The interface over a registry of its own, without a broker and without workers."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import netCDF4
import pytest
import uvicorn
import xarray as xr
from fastapi.testclient import TestClient

from service.access import KeyStore, Scope
from service.api.app import create_app
from service.cases import apply_settings, load_case
from service.jobs import Registry
from service.settings import Settings
from worker.run import run_next

HOUR = 3600.0
SMALL = {"t_end": 0.05, "output.interval": 0.01, "numerics.intervals": 8}


def dataset_of(content: bytes) -> xr.Dataset:
    """What a file holds. It is closed: left open, it would be by the garbage collector, in whichever thread that runs,
    while another, of the interface, is in the NetCDF library, which is not thread-safe."""
    with netCDF4.Dataset("x", memory=content) as file:
        return xr.open_dataset(xr.backends.NetCDF4DataStore(file)).load()


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


@pytest.fixture
def whole(client: TestClient, done: str) -> xr.Dataset:
    """Its dataset."""
    return dataset_of(client.get(f"/v1/jobs/{done}/dataset").content)


@pytest.fixture
def address(client: TestClient) -> Iterator[str]:
    """The same application behind a socket: other programs talk to that."""
    with socket.socket() as sock:
        sock.bind(("127.0.0.1", 0))
        server = uvicorn.Server(uvicorn.Config(client.app, lifespan="off", log_level="warning"))
        thread = threading.Thread(target=lambda: server.run(sockets=[sock]))
        thread.start()
        while not server.started:
            time.sleep(0.01)
        yield f"http://127.0.0.1:{sock.getsockname()[1]}"
        server.should_exit = True
        thread.join()


@pytest.fixture
def store(keyed) -> KeyStore:
    """The keys of an interface `keyed`, which modules make."""
    return keyed.app.state.parts.keys


@pytest.fixture
def key(store):
    """Headers with a new key of an owner."""

    def make(owner: str, *scopes: str, seconds: float = HOUR) -> dict[str, str]:
        new = store.create(owner, frozenset(map(Scope, scopes or ("read", "submit"))), seconds)
        return {"Authorization": f"Bearer {new.text}"}

    return make


@pytest.fixture
def alices(keyed, key, case) -> str:
    """The id of a job of alice's."""
    return keyed.post("/v1/jobs", json=case, headers=key("alice")).json()["id"]


def refused(answer, status, name):
    assert answer.status_code == status, answer.text
    assert answer.request.method == "HEAD" or answer.json()["type"] == f"urn:hockle:problem:{name}"
