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
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import httpx
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sqlalchemy.exc import OperationalError

from chaos.postgres import Postgres, binaries, postgres
from service.access import KeyStore, Scope
from service.api.app import create_app
from service.api.listening import listen
from service.cases import apply_settings, load_case, parse_case, shipped_cases
from service.jobs import Database, Job, NewJob, Registry, Status
from service.jobs.held import claim
from service.jobs.job import Reached
from service.settings import Settings
from worker.run import run_next

HERE, DATABASES = Path(__file__).parent, ["sqlite", "postgresql"]
LONG = os.environ.get("FUZZ") == "long"
MALFORMED = 10_000 if LONG else 250
DAY = 86400.0
ONLY_STATUSES = ["--checks", "content_type_conformance,response_headers_conformance"]
"""Of answers while the database comes and goes; their statuses are looked at afterwards."""
OUR_KEYS = ["--generation-with-security-parameters", "false"]  # and none of its own, which are all wrong
SEED = os.environ.get("FUZZ_SEED", "20260101")

NOWHERE_VALID: list[Any] = [{"nonsense": 1}, [[]], True, "\u2603 \u0000", 10**400, [None]]
NEVER_NUMBERS: list[Any] = [*NOWHERE_VALID, "1", -(10**400), None, []]
REQUIRED = ["/schema_version", "/rod", "/rod/length", "/rod/diameter", "/initial", "/initial/shape", "/ends",
            "/ends/start", "/ends/end", "/t_end", "/output", "/output/interval"]  # fmt: skip
POSITIVE = ["/rod/length", "/t_end", "/output/interval", "/numerics/dt_max", "/numerics/increment_tolerance"]
MAY_BE_NULL = ("/numerics/intervals", "/numerics/dt_max", "/numerics/increment_tolerance")  # as if it were not given
FREE_TEXT = ("/title", "/description")
CASES = [load_case(name) for name in shipped_cases()]


class Ran(NamedTuple):
    """Settings with which a job of alice's has run, that job, and keys of hers; PostgreSQL, if it is that."""

    settings: Settings
    server: Postgres | None
    job: Job
    keys: list[str | None]


@pytest.fixture(params=DATABASES)
def ran(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ran]:
    data = tmp_path_factory.mktemp("data")
    if request.param == "sqlite":
        yield ran_with(Settings(data=data), None)
    elif binaries() is None:
        pytest.skip("no PostgreSQL on this machine")
    else:
        with postgres(synced=False) as server:
            yield ran_with(Settings(data=data, database=server.create("fuzz")), server)


def ran_with(told: Settings, server: Postgres | None) -> Ran:
    told.make_directories()
    database = Database(told.database_url)
    short = apply_settings(load_case("cantilever-vibration"), {"t_end": 0.1, "output.interval": 0.02})
    job = Registry(database).submit(NewJob(parse_case(short).document(), owner="alice"))
    run_next(database, told)
    job = Registry(database).get(job.id)
    assert job.status is Status.SUCCESSFUL
    full, other = ({Scope.READ, Scope.SUBMIT}, {Scope.OPERATE})
    keys = [KeyStore(database).create("alice", frozenset(scopes), DAY).text for scopes in (full, other)]
    database.close()
    return Ran(told, server, job, [keys[0]] * 6 + [keys[1], None])


def examples(few: int, seconds: int, phases: str = "examples,fuzzing,stateful") -> list[str]:
    """How much schemathesis is to try: so many examples of an operation, or, for long, what `seconds` allow."""
    if LONG:
        return ["--max-examples", "50", "--max-time", str(seconds)]
    return ["--max-examples", str(few), "--phases", phases]


@contextmanager
def serving(settings: Settings, **environment: str) -> Iterator[str]:
    """The address of a running service, in a process of its own."""
    [listening] = listen("127.0.0.1", 0)
    with listening:
        command = [sys.executable, "-m", "hockle", "api", "--fd", str(listening.fileno())]
        told = {**os.environ, **settings.environment(), "REDIS_URL": "", **environment}
        process = subprocess.Popen(command, env=told, pass_fds=[listening.fileno()])
        try:
            address = f"http://127.0.0.1:{listening.getsockname()[1]}"
            until_ready(f"{address}/readyz", process)
            yield address
        finally:
            process.terminate()
            process.wait(60)


def until_ready(url: str, process: subprocess.Popen[bytes]) -> None:
    while process.poll() is None:
        try:
            httpx.get(url, timeout=60.0, trust_env=False).raise_for_status()
            return
        except httpx.HTTPError:
            continue
    pytest.fail("the service did not start")


@pytest.fixture
def waiting(ran: Ran, tmp_path: Path) -> Iterator[list[str]]:
    """The ids of jobs of alice's that wait. A job whose events are followed ends soon, as the one that has run, so
    that they come to an end; the others wait until they are dismissed."""
    database, over, followed = Database(ran.settings.database_url), threading.Event(), tmp_path / "followed"
    followed.touch()

    def end() -> None:
        known: set[str] = set()
        while not over.wait(0.2):
            for job_id in set(followed.read_text().split()) - known:
                with suppress(OperationalError):  # the database is away
                    if held := claim(database, job_id, 60.0, "fuzz"):
                        held.finish(Status.SUCCESSFUL, "completed", "", ran.job.dataset, Reached(1.0))
                    known.add(job_id)

    jobs = [Registry(database).submit(NewJob(Registry(database).case(ran.job.id), owner="alice")) for _ in range(2)]
    thread = threading.Thread(target=end)
    thread.start()
    yield [job.id for job in jobs]
    over.set()
    thread.join()
    database.close()


def schemathesis(
    address: str, ran: Ran, waiting: list[str], at: Path, *options: str, keys: Sequence[str | None] = ()
) -> Counter[str]:
    """Run it in the directory `at`; gives how often which status was answered."""
    for name in ("schemathesis.toml", "schemathesis_hooks.py"):
        shutil.copy(HERE / name, at)
    for name, ids in (("ran.dict", [ran.job.id]), ("waiting.dict", waiting)):
        (at / name).write_text("".join(f'"{id_}"\n' for id_ in ids))
    command = [str(Path(sys.executable).with_name("schemathesis")), "run", f"{address}/v1/openapi.json",
               "--seed", SEED, "--no-color", "--generation-database", "none", *options]  # fmt: skip
    told = subprocess.run(command, capture_output=True, text=True, timeout=1800, cwd=at,
                          env={**os.environ, "FUZZ_KEYS": json.dumps(keys)})  # fmt: skip
    assert told.returncode == 0, told.stdout[-20_000:] + told.stderr
    met = Counter((at / "statuses").read_text().split())
    print(told.stdout[-1500:], dict(sorted(met.items())))
    return met


def test_schemathesis_finds_nothing(ran, waiting, tmp_path):
    with serving(ran.settings) as address:
        few = 5 if ran.server is None else 3  # what differs by database is few statements
        schemathesis(address, ran, waiting, tmp_path, *examples(few, seconds=900))


@pytest.mark.parametrize("ran", ["postgresql"], indirect=True)
def test_while_the_database_goes_away_and_comes_back_there_is_only_503_and_right_after_nothing(ran, waiting, tmp_path):
    over, away = threading.Event(), tmp_path / "away"
    away.mkdir()

    def comes_and_goes() -> None:
        while not over.wait(1.0):
            ran.server.kill()
            time.sleep(1.0)
            ran.server.start()

    thread = threading.Thread(target=comes_and_goes)
    with serving(ran.settings) as address:
        thread.start()
        try:
            met = schemathesis(address, ran, waiting, away, *examples(3, seconds=300), *ONLY_STATUSES)
        finally:
            over.set()
            thread.join()
        assert met["503"] > 10 and met["200"] > 10
        assert [status for status in met if status.startswith("5") and status != "503"] == []
        assert httpx.get(f"{address}/v1/jobs", timeout=60.0, trust_env=False).status_code == 200
        schemathesis(address, ran, waiting, tmp_path, *examples(2, seconds=60, phases="examples,fuzzing"))


@pytest.mark.parametrize("ran", DATABASES if LONG else DATABASES[:1], indirect=True)  # keys are rows like any other
def test_schemathesis_finds_nothing_where_keys_are_required(ran, waiting, tmp_path):
    with serving(ran.settings, HOCKLE_REQUIRE_KEYS="1", HOCKLE_RATE="1000") as address:
        met = schemathesis(address, ran, waiting, tmp_path, *examples(3, 180), *OUR_KEYS, keys=ran.keys)
        assert {"200", "401", "403"} <= set(met)


@pytest.mark.parametrize("ran", ["sqlite"], indirect=True)  # the rate is counted by the process, not by the database
def test_schemathesis_finds_nothing_where_owners_ask_too_often(ran, waiting, tmp_path):
    with serving(ran.settings, HOCKLE_REQUIRE_KEYS="1", HOCKLE_RATE="0.5") as address:
        few = examples(2, 60, "examples,fuzzing")
        assert {"401", "429"} <= set(schemathesis(address, ran, waiting, tmp_path, *few, *OUR_KEYS, keys=ran.keys))


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
