"""Nobody gets in without a key, past its scopes, or to another owner's jobs: by no route of the interface."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.access import Scope
from service.api.app import ROUTERS, create_app
from service.api.gate import is_open
from service.settings import Settings
from tests.service.api.conftest import refused

SCOPE = {"GET": "read", "HEAD": "read", "POST": "submit", "PUT": "submit", "DELETE": "submit"}
OPERATORS = {"/metrics", "/v1/audit", "/v1/queue", "/v1/queue/pause", "/v1/hosts/{host}/pause"}


def operations() -> list[tuple[str, str]]:
    """Every route of the interface that needs a key, and how it is asked, those that its description leaves out too."""
    routes = [route for router in ROUTERS for route in router.routes if not is_open(route.path)]
    return [(method, route.path) for route in routes for method in sorted(route.methods)]


EVERY = pytest.mark.parametrize(("method", "path"), operations())


@pytest.fixture(scope="module")
def keyed(tmp_path_factory: pytest.TempPathFactory, empty_registry: Path) -> Iterator[TestClient]:
    """An interface that all routes are asked at: there are many, and none changes what another is asked for."""
    data = tmp_path_factory.mktemp("data")
    shutil.copy(empty_registry, data / "registry.db")
    app = create_app(replace(Settings(data=data), rate=1e6), keyed=True)
    with TestClient(app, base_url="http://127.0.0.1:8000", raise_server_exceptions=False) as client:
        yield client


def ask(client, method, path, headers, job_id="0" * 26, case=None):
    path = path.replace("{job_id}", job_id).replace("{name}", "elastica").replace("{process_id}", "simulate")
    path = path.replace("{link_id}", "0" * 12).replace("{host}", "nowhere")
    path += "?variables=Tw" if path.endswith("/data") else f"?variables=Tw&jobs={job_id}" if "scalars" in path else ""
    return client.request(method, path, headers=headers, json=(case or {}) if method == "POST" else None)


@EVERY
def test_no_route_answers_without_a_key(keyed, alices, method, path):
    answer = ask(keyed, method, path, {}, alices)
    refused(answer, 401, "not_authenticated")
    assert answer.headers["www-authenticate"] == "Bearer"


@EVERY
def test_no_route_answers_an_expired_a_revoked_or_an_unknown_key(keyed, key, store, alices, method, path):
    expired, revoked = key("alice", seconds=-1.0), key("alice")
    store.revoke(revoked["Authorization"].split("_")[1])
    for headers in (expired, revoked, {"Authorization": "Bearer hk_0123456789ab_" + "x" * 43}):
        refused(ask(keyed, method, path, headers, alices), 401, "not_authenticated")


@EVERY
def test_no_route_answers_a_key_with_too_few_scopes(keyed, key, alices, method, path):
    keyed.delete(f"/v1/jobs/{alices}", headers=key("alice"))  # its events come to an end
    needed = "operate" if path in OPERATORS else SCOPE[method]
    others = [scope for scope in Scope if scope != needed]
    refused(ask(keyed, method, path, key("alice", *others), alices), 403, "scope_missing")
    assert ask(keyed, method, path, key("alice", needed), alices).status_code not in (401, 403)


@pytest.mark.parametrize(("method", "path"), [one for one in operations() if "{job_id}" in one[1]])
def test_what_is_anothers_is_not_there(keyed, key, alices, method, path):
    answer = ask(keyed, method, path, key("bob"), alices)
    assert answer.status_code == 404
    unknown = ask(keyed, method, path, key("bob"), "0" * 26)
    if method != "HEAD":
        assert answer.json() == {**unknown.json(), "detail": unknown.json()["detail"].replace("0" * 26, alices)}
    assert keyed.get(f"/v1/jobs/{alices}", headers=key("alice")).json()["status"] == "accepted"
