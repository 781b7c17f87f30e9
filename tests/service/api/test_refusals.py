"""Whatever a client sends, it is told what is wrong, as a problem, and no job comes of it."""

from __future__ import annotations

import asyncio
import json
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy.exc import InterfaceError, OperationalError

from service.api import bodies
from service.api.app import create_app
from service.api.bodies import LARGEST_BODY, SMALL_BODY, at_leisure, parse
from service.api.problems import Problem
from service.cases import CaseError
from service.settings import Settings

JSON = {"Content-Type": "application/json"}

NOT_JSON: dict[str, bytes] = {
    "empty": b"", "blank": b"  ", "word": b"hello", "half": b'{"rod": ', "tail": b"{} {}",
    "comma": b'{"a": 1,}',
    "single quotes": b"{'a': 1}", "nan": b'{"t_end": NaN}', "infinity": b'{"t_end": Infinity}',
    "minus infinity": b'{"t_end": -Infinity}', "overflow": b'{"t_end": 1e999}', "latin": b'{"name": "\xe9"}',
    "utf-16": '{"a": 1}'.encode("utf-16"), "bom": b"\xef\xbb\xbf{}", "control": b'{"name": "\x00"}',
    "surrogate": rb'{"name": "\ud800"}', "twice": b'{"t_end": 1, "t_end": 2}', "comment": b"{} // x",
    "deep": b'{"a":' * 50_000 + b"1" + b"}" * 50_000, "deep list": b"[" * 100_000,
    "huge integer": b'{"t_end": ' + b"9" * 10_000 + b"}", "hex": b'{"t_end": 0x10}', "plus": b'{"t_end": +1}',
    "list": b"[]", "string": b'"goyal-2003"', "number": b"1", "null": b"null", "true": b"true",
}

CHANGES: dict[str, tuple[str, Any]] = {
    "negative end": ("t_end", -1), "zero end": ("t_end", 0), "text for a number": ("t_end", "34"),
    "true for a number": ("t_end", True), "list for a number": ("t_end", [1]),
    "null for a number": ("t_end", None),
    "unknown field": ("colour", "red"), "unknown nested field": ("rod.colour", "red"),
    "text for an object": ("rod", "long"), "list for an object": ("rod", []), "null rod": ("rod", None),
    "negative length": ("rod.length", -1.0), "another schema": ("schema_version", 2),
    "text schema": ("schema_version", "1"), "method": ("numerics.method", "magic"),
    "solver": ("numerics.linear_solver", "guess"), "no intervals": ("numerics.intervals", 0),
    "half an interval": ("numerics.intervals", 2.5), "too many intervals": ("numerics.intervals", 10**9),
    "rho": ("numerics.rho_inf", 1.5), "dt": ("numerics.dt_max", 0), "tiny dt": ("numerics.dt_max", 1e-12),
    "interval": ("output.interval", 0), "interval past the end": ("output.interval", 1e6),
    "tiny interval": ("output.interval", 1e-9), "fields": ("output.fields", ["nonsense"]),
    "no fields": ("output.fields", []), "fields twice": ("output.fields", ["v", "v"]),
    "name": ("name", "../../etc/passwd"), "long name": ("name", "a" * 500),
    "long title": ("title", "a" * 5000),
    "ends": ("ends", {}), "end": ("ends.start", {"kind": "glued"}), "huge": ("rod.length", 10**400),
    "fluid": ("fluid", {"density": -1}), "contact": ("contact", {"k1": -1}),
    "loads": ("loads", {"wind": 3}),
}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory, empty_registry: Path) -> Iterator[TestClient]:
    """An interface that all refusals are asked of: none leaves anything behind."""
    data = tmp_path_factory.mktemp("data")
    shutil.copy(empty_registry, data / "registry.db")
    with TestClient(create_app(Settings(data=data)), base_url="http://127.0.0.1:8000",
                    raise_server_exceptions=False) as client:  # fmt: skip
        yield client


def assert_problem(answer: Any, *statuses: int) -> dict[str, Any]:
    assert answer.status_code in statuses, answer.text[:300]
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert problem["status"] == answer.status_code
    assert problem["type"].startswith("urn:hockle:problem:") and problem["title"] and problem["detail"]
    return problem


@pytest.mark.parametrize("where", ["/v1/jobs", "/v1/validate"])
@pytest.mark.parametrize("name", NOT_JSON)
def test_what_is_not_a_json_object_is_refused(client, where, name):
    assert_problem(client.post(where, content=NOT_JSON[name], headers=JSON), 400)
    assert client.get("/v1/jobs").json()["jobs"] == []


def test_a_slip_in_a_body_is_told_with_its_place_and_what_was_meant(client):
    body = b'{"case": "goyal-2003",\n "set": {"rod.length": 1,5}}'
    problem = assert_problem(client.post("/v1/validate", content=body, headers=JSON), 400)
    assert problem["type"] == "urn:hockle:problem:malformed_json"
    assert problem["detail"] == ("the body is not strict JSON: line 2, column 26: a number has a decimal point, not a "
                                 """comma: write 1.5, not 1,5: '"set": {"rod.length": 1,5}}'""")


@pytest.mark.parametrize(("number", "column"), [("NaN", 19), ("-Infinity", 19), ("1e999", 19)])
def test_a_number_that_is_not_finite_is_told_with_its_place(client, number, column):
    body = f'{{"name": "{number}",\n "set": {{"t_end": {number}}}}}'.encode()
    problem = assert_problem(client.post("/v1/validate", content=body, headers=JSON), 400)
    assert f"line 2, column {column}: numbers must be finite, got {number}: " in problem["detail"]


@pytest.mark.parametrize("name", CHANGES)
def test_a_faulty_case_is_refused_with_a_pointer_to_each_fault(client, case, name):
    key, value = CHANGES[name]
    *parents, last = key.split(".")
    place = case
    for parent in parents:
        place = place[parent]
    place[last] = value
    problem = assert_problem(client.post("/v1/jobs", content=json.dumps(case), headers=JSON), 422)
    assert problem["errors"]
    for error in problem["errors"]:
        assert set(error) == {"pointer", "value", "rule"}
        assert error["pointer"].startswith("/" + key.split(".")[0]) or error["pointer"] == ""
    assert client.get("/v1/jobs").json()["jobs"] == []


@pytest.mark.parametrize(("body", "pointer"), [
    ({"case": "goyal-2004"}, "/case"),
    ({"case": "../service/cases/shipped/goyal-2003"}, "/case"),
    ({"case": "/etc/passwd"}, "/case"),
    ({"case": 1}, "/case"),
    ({"case": {}}, "/case/rod"),
    ({"case": "goyal-2003", "set": {"t_end": 1e9}}, "/output/interval"),
    ({"case": "goyal-2003", "label": "a\nb"}, "/label"),
    ({"case": "goyal-2003", "priority": 0.5}, "/priority"),
    ({"case": "goyal-2003", "priority": 1000}, "/priority"),
    ({"case": "goyal-2003", "reuse": "no"}, "/reuse"),
    ({"case": "goyal-2003", "webhook": "file:///etc/passwd"}, "/webhook"),
    ({"case": "goyal-2003", "limits": {"wall": 0}}, "/limits/wall"),
    ({"case": "goyal-2003", "limits": {"memory": 1000}}, "/limits/memory"),
    ({"case": "goyal-2003", "limits": {"cores": 4}}, "/limits/cores"),
    ({"case": "goyal-2003", "set": []}, "/set"),
    ({"case": "goyal-2003", "sets": {}}, "/sets"),
    ({"case": "goyal-2003", "set": {"t_end": "x"}}, "/t_end"),
    ({"case": "goyal-2003", "set": {"t_end.x": 1}}, "/t_end"),
    ({"case": "goyal-2003", "set": {"": 1}}, "/"),
])
def test_a_faulty_reference_to_a_shipped_case_is_refused(client, body, pointer):
    problem = assert_problem(client.post("/v1/jobs", json=body), 422)
    assert pointer in [error["pointer"] for error in problem["errors"]]


def test_a_key_that_leads_deeper_than_any_field_is_refused(client):
    answer = client.post("/v1/jobs", json={"case": "hanging-cable", "set": {".".join("a" * 5000): 1}})
    assert answer.status_code == 422 and "at most 20 parts" in answer.json()["detail"]
    assert len(answer.content) < 1000


def test_several_faults_are_told_together(client, case):
    case["t_end"], case["rod"]["length"], case["colour"] = -1, "x", 1
    problem = assert_problem(client.post("/v1/validate", json=case), 422)
    assert {"/t_end", "/colour"} <= {error["pointer"] for error in problem["errors"]}


@pytest.mark.parametrize("content_type", ["text/plain", "application/x-www-form-urlencoded", "text/json", ""])
def test_a_body_of_another_type_is_refused(client, content_type):
    assert_problem(client.post("/v1/jobs", content=b"{}", headers={"Content-Type": content_type}), 415)


def test_a_body_over_the_bound_is_refused_whether_its_length_is_told_or_not(client):
    large = b'{"title": "' + b"x" * LARGEST_BODY + b'"}'
    assert_problem(client.post("/v1/jobs", content=large, headers=JSON), 413)
    chunks = (large[i : i + 65536] for i in range(0, len(large), 65536))
    assert_problem(client.post("/v1/jobs", content=chunks, headers=JSON), 413)


@pytest.mark.parametrize("job_id", ["nobody", "01jzzzzzzzzzzzzzzzzzzzzzzz", "%00", "..%2fetc", "x" * 999])
@pytest.mark.parametrize("what", ["", "/dataset", "/data?variables=Tw"])
def test_an_unknown_job_is_told_so(client, job_id, what):
    assert_problem(client.get(f"/v1/jobs/{job_id}{what}"), 404)


@pytest.mark.parametrize(("method", "path", "status"), [
    ("DELETE", "/v1/jobs/nobody", 404), ("GET", "/v2/jobs", 404), ("GET", "/v1/jobs/", 404),
    ("GET", "/v1/cases/nothing", 404), ("GET", "/v1/cases/..%2f..%2fx", 404), ("PUT", "/v1/jobs", 405),
    ("POST", "/v1/jobs/nobody", 405), ("POST", "/readyz", 405), ("DELETE", "/v1/cases", 405),
])
def test_what_is_not_there_or_not_allowed_is_a_problem(client, method, path, status):
    answer = client.request(method, path)
    assert_problem(answer, status)
    assert status != 405 or answer.headers["allow"]


@pytest.mark.parametrize("query", ["limit=0", "limit=5.0", "limit=201", "limit=x", "status=done", "page=2"])
def test_a_faulty_list_query_is_refused_by_the_name_of_its_parameter(client, query):
    problem = assert_problem(client.get(f"/v1/jobs?{query}"), 422)
    assert [error["parameter"] for error in problem["errors"]] == [query.partition("=")[0]]


@pytest.mark.parametrize(("query", "told"), [
    ("", "variables is required"), ("variables=r&t_min=abc", "t_min must be a number, got 'abc'"),
    ("variables=r&t_min=5&t_max=1", "t_max must be >= t_min, which is 5.0, got 1.0"),
    ("variables=r&s_min=1&s_max=0", "s_max must be >= s_min, which is 1.0, got 0.0"),
    ("variables=r&time_stride=0", "time_stride must be >= 1, got '0'"),
    ("variables=r&time_stride=2.5", "time_stride must be a whole number in digits, got '2.5'"),
    ("variables=r&format=xml", "format must be 'json', 'csv', 'netcdf' or 'arrow', got 'xml'"),
    ("variables=r&t_mim=5", "t_mim is not a known field, got '5': did you mean t_min?"),
])
def test_a_refused_query_names_the_parameter_the_value_and_the_rule(client, query, told):
    problem = assert_problem(client.get(f"/v1/jobs/nobody/data?{query}"), 422)
    assert problem["detail"] == told
    assert problem["errors"][0]["parameter"] == told.split()[0]


def test_a_refused_body_names_the_field_the_value_and_the_rule(client):
    assert assert_problem(client.post("/v1/jobs/nobody/links", json={"hours": 1}), 422)["detail"] == (
        "/hours is not a known field, got 1")
    ranged = {"case": "elastica", "parameters": {"loads.damping": {"low": 1, "high": 2}}}
    assert assert_problem(client.post("/v1/ensembles", json=ranged), 422)["detail"] == (
        "/parameters/loads.damping/low needs a sample, which says how the range is filled")


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "10.0.0.7:80", "", "[::1", "a@127.0.0.1",
                                  "127.0.0.1/x", "127.0.0.1?x", "127.0.0.1#x", "127.0.0.1:99999", "127.0.0.1:x"])
def test_a_foreign_host_is_refused(client, host):
    assert_problem(client.get("/v1/jobs", headers={"Host": host}), 421)


@pytest.mark.parametrize("host", ["localhost:8000", "127.0.0.1", "[::1]:8000", "LOCALHOST"])
def test_every_name_of_this_machine_is_welcome(client, host):
    assert client.get("/readyz", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://127.0.0.1:9999"])
def test_a_page_from_elsewhere_may_not_write(client, case, origin):
    assert_problem(client.post("/v1/jobs", json=case, headers={"Origin": origin}), 403)
    assert_problem(client.delete("/v1/jobs/nobody", headers={"Origin": origin}), 403)


def test_a_bug_is_a_problem_without_its_details(client, monkeypatch):
    monkeypatch.setattr("service.jobs.Registry.page", lambda *_: 1 / 0)
    problem = assert_problem(client.get("/v1/jobs"), 500)
    assert "division" not in json.dumps(problem)


def test_faults_of_a_case_are_those_of_its_validation(case):
    from service.cases import parse_case

    with pytest.raises(CaseError):
        parse_case(case | {"t_end": -1})


def test_a_body_with_a_key_twice_is_refused_however_many_there_are():
    for many in (10, 100_000):
        pairs = ",".join(f'"k{i}":1' for i in range(many))
        with pytest.raises(Problem, match="stands twice" if many == 10 else "at most 1000 members"):
            parse(f'{{{pairs},"k{many - 1}":2}}'.encode())


def test_reading_an_object_looks_at_each_key_once():
    class Counted(str):
        compared = 0
        __hash__ = str.__hash__

        def __eq__(self, other):
            Counted.compared += 1
            return str.__eq__(self, other)

    pairs = [(Counted(f"k{i}"), 1) for i in range(900)]
    with pytest.raises(ValueError, match="stands twice"):
        bodies._without_doubles([*pairs, (Counted("k899"), 2)])
    assert Counted.compared < 3 * len(pairs)


@pytest.mark.parametrize("size", [SMALL_BODY, SMALL_BODY + 1])
def test_a_large_body_is_read_beside_the_event_loop(size):
    async def threads() -> set[int]:
        return {threading.get_ident(), await at_leisure(size, threading.get_ident)}

    assert len(asyncio.run(threads())) == (1 if size == SMALL_BODY else 2)


def test_of_many_faults_the_first_are_told_and_how_many_more(client, case):
    faulty = case | {f"x{i}": "y" * 100 for i in range(900)} | {"z" * 2000: 1}
    answer = client.post("/v1/jobs", json=faulty)
    assert answer.status_code == 422 and len(answer.content) < 60_000
    told = answer.json()
    assert len(told["errors"]) == 100
    assert told["detail"].endswith("and 898 more")


@pytest.mark.parametrize("query", ["label=a%00b", "owner=%00"])
def test_no_filter_has_a_nul(client, query):
    assert client.get(f"/v1/jobs?{query}").status_code == 422


@pytest.mark.parametrize("field", ["title", "label"])
def test_no_text_of_a_submission_has_control_characters(client, case, field):
    body = {"case": case | {"title": "a\0b"}} if field == "title" else {"case": case, "label": "a\0b"}
    assert client.post("/v1/jobs", json=body).status_code == 422


def test_a_request_has_one_host(client):
    twice = [("Host", "127.0.0.1:8000"), ("Host", "evil.example")]
    assert client.get("/livez", headers=twice).json()["type"] == "urn:hockle:problem:one_host"


@pytest.mark.parametrize("error", [OperationalError, InterfaceError])
def test_a_database_that_is_away_or_full_is_told_with_when_to_come_back(client, monkeypatch, error):
    def away(*_, **__):
        raise error("INSERT", {}, Exception("database or disk is full"))

    monkeypatch.setattr("service.jobs.Registry.page", away)
    answer = client.get("/v1/jobs")
    assert (answer.status_code, answer.headers["Retry-After"]) == (503, "10")
    assert answer.json()["type"] == "urn:hockle:problem:database_unreachable"


@pytest.mark.parametrize("name", ["<", "<name>", "", "/", "~", "\u2028", "a" * 5000])
def test_a_field_of_any_name_is_refused_by_it(client, case, name):
    """Found by `make attack`: a field called < was a 500."""
    for body in (case | {name: 1}, {"case": case, name: 1}, {name: 1}):
        answer = client.post("/v1/jobs", json=body)
        assert answer.status_code == 422
        pointer = "/" + name.replace("~", "~0").replace("/", "~1")
        assert any(pointer.startswith(error["pointer"].removesuffix("...")) for error in answer.json()["errors"])
