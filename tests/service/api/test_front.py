"""Cases to start from, the dashboard, the state of health, the interface's own description."""

from __future__ import annotations

import re

import pytest

from service.cases import parse_case, shipped_cases


def test_every_shipped_case_is_listed_and_valid(client):
    listed = client.get("/v1/cases").json()
    assert listed == shipped_cases()
    for name in listed:
        parse_case(client.get(f"/v1/cases/{name}").json())


def test_the_schema_describes_a_case(client):
    schema = client.get("/v1/cases/schema").json()
    assert {"rod", "initial", "ends", "t_end", "output"} <= set(schema["properties"])


def test_validation_says_what_a_case_asks_for_and_makes_no_job(client, case):
    told = client.post("/v1/validate", json=case).json()
    assert (told["cost"]["nodes"], told["cost"]["frames"]) == (9, 6)
    assert told["case"]["numerics"]["intervals"] == 8
    assert client.get("/v1/jobs").json()["jobs"] == []


def test_no_other_page_may_frame_the_dashboard_and_it_asks_by_a_form(client):
    page = client.get("/")
    assert "frame-ancestors 'none'" in page.headers["content-security-policy"]
    assert "prompt(" not in page.text and 'type="password"' in page.text


def test_the_dashboard_needs_nothing_from_elsewhere(client):
    page = client.get("/")
    assert page.headers["content-type"].startswith("text/html")
    assert not re.search(r"""(src|href)=["'](https?:)?//""", page.text)
    assert "default-src 'self'" in page.headers["content-security-policy"]


def test_the_interface_describes_itself(client):
    told = client.get("/v1/openapi.json").json()
    assert told["openapi"].startswith("3.1.")
    assert {"/v1/jobs", "/v1/jobs/{job_id}", "/v1/jobs/{job_id}/dataset", "/v1/validate"} <= set(told["paths"])
    for path, operations in told["paths"].items():
        for method, operation in operations.items():
            assert operation["summary"] and operation["description"] and operation["tags"], (method, path)
            for parameter in operation.get("parameters", []):
                assert parameter["description"], (method, path, parameter["name"])


@pytest.mark.parametrize(("path", "headers", "status"), [
    ("/", {}, 200), ("/dashboard/main.js", {}, 200), ("/livez", {}, 200), ("/v1/jobs", {}, 200), ("/metrics", {}, 200),
    ("/v1/jobs/nobody", {}, 404), ("/v1/jobs", {"Host": "evil.example"}, 421), ("/nowhere", {}, 404),
])  # fmt: skip
def test_every_answer_tells_browsers_to_do_no_more_with_it_than_they_should(client, path, headers, status):
    answer = client.get(path, headers=headers)
    told = answer.headers
    assert answer.status_code == status
    assert "frame-ancestors 'none'" in told["content-security-policy"]
    assert told["x-content-type-options"] == "nosniff" and told["x-frame-options"] == "DENY"
    assert told["referrer-policy"] == "no-referrer"
    assert told["cross-origin-resource-policy"] == told["cross-origin-opener-policy"] == "same-origin"
    assert len(told.get_list("content-security-policy")) == 1
