"""The running interface against whatever is sent: schemathesis with all checks, and malformed cases by the thousand.

`make fuzz` does the same for longer: FUZZ=long.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from service.api.app import create_app
from service.api.listening import listen
from service.cases import apply_settings, load_case, parse_case, shipped_cases
from service.jobs import Database, NewJob, Registry, Status
from service.settings import Settings
from worker.run import run_next

HERE = Path(__file__).parent
LONG = os.environ.get("FUZZ") == "long"
MALFORMED = 10_000 if LONG else 500
SCHEMATHESIS = (["--max-examples", "50", "--max-time", "900"] if LONG else
                ["--max-examples", "8", "--phases", "examples,fuzzing,stateful"])  # fmt: skip
SEED = os.environ.get("FUZZ_SEED", "20260101")

NOWHERE_VALID: list[Any] = [{"nonsense": 1}, [[]], True, "\u2603 \u0000", 10**400, [None]]
NEVER_NUMBERS: list[Any] = [*NOWHERE_VALID, "1", -(10**400), None, []]
REQUIRED = ["/schema_version", "/rod", "/rod/length", "/rod/diameter", "/initial", "/initial/shape", "/ends",
            "/ends/start", "/ends/end", "/t_end", "/output", "/output/interval"]  # fmt: skip
POSITIVE = ["/rod/length", "/t_end", "/output/interval", "/numerics/dt_max", "/numerics/increment_tolerance"]
MAY_BE_NULL = ("/numerics/intervals", "/numerics/dt_max", "/numerics/increment_tolerance")  # as if it were not given
FREE_TEXT = ("/title", "/description")
CASES = [load_case(name) for name in shipped_cases()]


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A data directory in which a job has run, and its id."""
    told = Settings(data=tmp_path_factory.mktemp("data"))
    told.make_directories()
    database = Database(told.database_url)
    short = apply_settings(load_case("cantilever-vibration"), {"t_end": 0.1, "output.interval": 0.02})
    job = Registry(database).submit(NewJob(parse_case(short).document()))
    run_next(database, told)
    assert Registry(database).get(job.id).status is Status.SUCCESSFUL
    database.close()
    return told.data, job.id


@pytest.fixture(scope="module")
def address(ran: tuple[Path, str], until_ready) -> Iterator[str]:
    """A running service, in a process of its own."""
    [listening] = listen("127.0.0.1", 0)
    with listening:
        command = [sys.executable, "-m", "service.api", "--fd", str(listening.fileno())]
        environment = {**os.environ, "HOCKLE_DATA": str(ran[0]), "REDIS_URL": ""}
        process = subprocess.Popen(command, env=environment, pass_fds=[listening.fileno()])
        try:
            address = f"http://127.0.0.1:{listening.getsockname()[1]}"
            until_ready(f"{address}/readyz", process)
            yield address
        finally:
            process.terminate()
            process.wait(60)


@pytest.fixture
def dismissing(address: str) -> Iterator[None]:
    """Each job is dismissed soon after it was accepted, so that the stream of its events ends."""
    over = threading.Event()

    def dismiss() -> None:
        with httpx.Client(base_url=address, timeout=60.0, trust_env=False) as client:
            while not over.wait(0.5):
                for job in client.get("/v1/jobs", params={"status": "accepted"}).json()["jobs"]:
                    client.delete(f"/v1/jobs/{job['id']}")

    thread = threading.Thread(target=dismiss)
    thread.start()
    yield
    over.set()
    thread.join()


@pytest.fixture(scope="module")
def until_ready():
    def wait(url: str, process: subprocess.Popen[bytes]) -> None:
        while process.poll() is None:
            try:
                httpx.get(url, timeout=60.0, trust_env=False).raise_for_status()
                return
            except httpx.HTTPError:
                continue
        pytest.fail("the service did not start")

    return wait


def test_schemathesis_finds_nothing(address, ran, dismissing, tmp_path):
    config = shutil.copy(HERE / "schemathesis.toml", tmp_path)
    (tmp_path / "ran.dict").write_text(f'"{ran[1]}"\n')
    command = [str(Path(sys.executable).with_name("schemathesis")), "--config-file", str(config), "run",
               f"{address}/v1/openapi.json", "--seed", SEED, "--no-color",
               "--generation-database", "none", *SCHEMATHESIS]  # fmt: skip
    told = subprocess.run(command, capture_output=True, text=True, timeout=1800, cwd=tmp_path)
    assert told.returncode == 0, told.stdout[-20_000:] + told.stderr
    print(told.stdout[-1500:])


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    app = create_app(Settings(data=tmp_path_factory.mktemp("malformed")))
    with TestClient(app, base_url="http://127.0.0.1:8000", raise_server_exceptions=False) as client:
        yield client


def places(value: Any, pointer: str = "") -> Iterator[tuple[str, Any]]:
    """Every place in a document, with what stands there."""
    yield pointer, value
    if isinstance(value, dict):
        for key, below in value.items():
            yield from places(below, f"{pointer}/{key}")
    elif isinstance(value, list):
        for i, below in enumerate(value):
            yield from places(below, f"{pointer}/{i}")


def changed(document: Any, pointer: str, change: Any) -> Any:
    """A copy of a document in which `change` was made to the parent of a place: called with parent and key."""
    copy = json.loads(json.dumps(document))
    *parents, last = pointer.split("/")[1:]
    parent = copy
    for part in parents:
        parent = parent[int(part) if isinstance(parent, list) else part]
    change(parent, int(last) if isinstance(parent, list) else last)
    return copy


@st.composite
def malformed(draw: st.DrawFn) -> tuple[dict[str, Any], str]:
    """A case with one fault, and the pointer to it."""
    case = draw(st.sampled_from(CASES))
    found = [(pointer, value) for pointer, value in places(case) if pointer and pointer not in FREE_TEXT]
    kind = draw(st.sampled_from(["type", "number", "unknown", "missing"]))
    if kind == "type":
        pointer, value = draw(st.sampled_from(found))
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        never = NEVER_NUMBERS if number else [bad for bad in NOWHERE_VALID if type(bad) is not type(value)]
        if pointer in MAY_BE_NULL:
            never = [bad for bad in never if bad is not None]
        bad = draw(st.sampled_from(never))
        return changed(case, pointer, lambda parent, key: parent.__setitem__(key, bad)), pointer
    if kind == "number":
        here = [pointer for pointer in POSITIVE if pointer in dict(found)]
        pointer, bad = draw(st.sampled_from(here)), -draw(st.floats(0, 1e300))
        return changed(case, pointer, lambda parent, key: parent.__setitem__(key, bad)), pointer
    if kind == "unknown":
        objects = [pointer for pointer, value in places(case) if isinstance(value, dict)]
        name = "~" + draw(st.text(st.characters(codec="utf-8", exclude_characters="~/"), max_size=20))
        pointer = draw(st.sampled_from(objects)) + f"/{name}"
        return changed(case, pointer, lambda parent, key: parent.__setitem__(key, 1)), pointer.replace("~", "~0")
    pointer = draw(st.sampled_from([one for one in REQUIRED if one in dict(found)]))
    return changed(case, pointer, lambda parent, key: parent.__delitem__(key)), pointer


WAYS = {
    "/v1/jobs": [("", lambda case: case), ("/case", lambda case: {"case": case, "label": "fuzz"})],
    "/v1/validate": [("", lambda case: case), ("/case", lambda case: {"case": case})],
    "/ogc/processes/simulate/execution": [("/inputs/case", lambda case: {"inputs": {"case": case}})],
}
"""Where a case may be sent to, how it is wrapped there, and so where its own pointers begin."""


def test_a_malformed_case_is_refused_with_a_pointer_to_its_fault_and_makes_no_job(client):
    seen = 0

    @settings(max_examples=MALFORMED, deadline=None, database=None, derandomize=True,
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(malformed(), st.sampled_from([(path, *way) for path, ways in WAYS.items() for way in ways]))
    def refused(one: tuple[dict[str, Any], str], way: tuple[str, str, Callable[[Any], Any]]) -> None:
        nonlocal seen
        (case, inside), (path, prefix, wrapped) = one, way
        answer = client.post(path, content=json.dumps(wrapped(case)), headers={"Content-Type": "application/json"})
        assert answer.status_code == 422, answer.text
        told = [error["pointer"] for error in answer.json()["errors"]]
        assert any(f"{one}/".startswith(f"{prefix}{inside}/") for one in told), (path, prefix, inside, told)
        seen += 1

    refused()
    assert client.get("/v1/jobs").json()["jobs"] == []
    print(f"{seen} malformed cases refused")
