"""While the database is away or has no room, whatever needs it is answered 503; right after, all is well."""

from __future__ import annotations

import secrets
from collections import defaultdict
from collections.abc import Iterator

import pytest
from fastapi.testclient import TestClient

from chaos.disk import fill, small_disk
from chaos.postgres import Postgres, binaries, postgres
from service.access import KeyStore, Scope
from service.api.app import create_app
from service.jobs import Database
from service.settings import Settings

ALWAYS = ("/", "/livez", "/readyz", "/v1/openapi.json")
"""What is answered without a database."""


@pytest.fixture
def server() -> Iterator[Postgres]:
    if binaries() is None:
        pytest.skip("no PostgreSQL on this machine")
    with postgres(synced=False) as server:
        yield server


def keyed(settings: Settings) -> TestClient:
    """A client with a key."""
    settings.make_directories()
    database = Database(settings.database_url)
    key = KeyStore(database).create("alice", frozenset(Scope), 1e6).text
    database.close()
    app = create_app(settings, keyed=True)
    return TestClient(app, base_url="http://127.0.0.1:8000", raise_server_exceptions=False,
                      headers={"Authorization": f"Bearer {key}"})


def calls(client: TestClient, job_id: str, case: dict) -> dict[str, int]:
    """Every call of the interface, with the status it is answered by; each 503 says when to come again."""
    told = client.get("/v1/openapi.json").json()
    found = {}
    for path, operations in told["paths"].items():
        if path.endswith("/events"):  # where the database can be read it goes on and on
            continue
        for method in operations:
            named = {"job_id": job_id, "process_id": "simulate", "name": "elastica", "what": "dds"}
            address = path.format_map(defaultdict(lambda: "0", named))
            body = {"case": case, "reuse": False} if "execution" not in path else {"inputs": {"case": case}}
            body = {"seconds": 60.0} if path.endswith("links") else body
            answer = client.request(method, address, json=body if method in ("post", "put") else None)
            found[f"{method} {path}"] = answer.status_code
            if answer.status_code == 503 and path not in ALWAYS:
                assert answer.headers["Retry-After"], path
                assert answer.headers["Content-Type"] == "application/problem+json"
    return found


def test_every_call_is_503_while_postgresql_is_away_and_right_after_it_is_back(server, case, tmp_path, until):
    client = keyed(Settings(data=tmp_path, database=server.create(f"test_{secrets.token_hex(8)}")))
    with client:
        before = calls(client, client.post("/v1/jobs", json=case).json()["id"], case)
        job_id = client.post("/v1/jobs", json={"case": case, "reuse": False}).json()["id"]
        server.kill()
        assert client.get(f"/v1/jobs/{job_id}/events").status_code == 503
        away = calls(client, job_id, case)
        assert {call: status for call, status in away.items() if status != 503 and call.split()[1] not in ALWAYS} == {}
        until(lambda: client.get("/readyz").status_code == 503, "it says so")
        server.start()
        until(lambda: client.get("/readyz").status_code == 200, "it says so")
        assert calls(client, job_id, case) == before


def test_what_needs_to_write_is_503_while_the_disk_is_full_and_right_after_there_is_room(case, tmp_path, until):
    with small_disk(tmp_path / "data") as small:
        if not small:
            pytest.skip("this user may not mount a small disk")
        client = keyed(Settings(data=tmp_path / "data"))
        with client:
            before = calls(client, client.post("/v1/jobs", json=case).json()["id"], case)
            job_id = client.post("/v1/jobs", json={"case": case, "reuse": False}).json()["id"]
            fill(tmp_path / "data" / "ballast")
            until(lambda: _submitted(client, case) != 202, "the log has no room left")
            full = calls(client, job_id, case)
            assert 500 not in full.values()
            unwell = {call for call, status in full.items() if status == 503}
            assert {"post /v1/jobs", "post /v1/jobs/{job_id}/cancel", "get /readyz"} <= unwell
            assert [call for call in unwell if call.startswith("get ")] == ["get /readyz"]
            (tmp_path / "data" / "ballast").unlink()
            until(lambda: client.get("/readyz").status_code == 200, "it says so")
            assert calls(client, job_id, case) == before


def _submitted(client: TestClient, case: dict) -> int:
    return client.post("/v1/jobs", json={"case": case, "reuse": False}).status_code
