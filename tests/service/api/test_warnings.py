"""POST /v1/validate warns of slips."""

from __future__ import annotations

from fastapi.testclient import TestClient


def test_validation_warns_of_a_slip_and_refuses_nothing(client: TestClient):
    changed = {"case": "elastica", "set": {"loads.gravity": [0.0, 0.0, 9.81]}}
    [warning] = client.post("/v1/validate", json=changed).json()["warnings"]
    assert warning == {"pointer": "/loads/gravity", "value": [0.0, 0.0, 9.81],
                       "rule": "points along +e3, which is upwards in most scenes"}
    assert client.post("/v1/validate", json={"case": "elastica"}).json()["warnings"] == []
