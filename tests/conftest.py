"""What tests of every package may use."""

from __future__ import annotations

import gc
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from uuid import uuid4

import pytest

from hockle.parts import SINGLE_THREADED

# before numpy is imported: beside other tests, BLAS would spend more on waiting for its threads than on its sums
os.environ.update(SINGLE_THREADED | os.environ)

from service.jobs import Database
from service.results import bucket

LONGEST = 60.0


COMPILED = (
    "solver.warm('box'), load('box', True, 'banded'), load('box', True, 'shooting'), load('box', True, wide=True)",
    "solver.warm('staggered'); from solver.run.equilibria import exercise; exercise()",
)
"""All kernels that tests need, in two parts that take as long as each other."""

LONG = (
    "service/api/test_fuzz.py", "docs/test_site.py", "hockle/test_supervisor.py", "docs/test_pages.py",
    "chaos/test_campaign.py", "hockle/test_standing_still.py", "hockle/test_rolling_upgrade.py",
    "client/test_restarts.py", "hockle/test_two_hosts.py", "service/dashboard/test_loss.py",
    "service/dashboard/test_cable.py", "hockle/test_strict_host.py", "client/test_ensembles.py",
    "worker/test_trials.py", "test_warm.py", "chaos/test_attack.py", "client/test_client.py",
    "hockle/test_worker_alone.py", "service/api/test_again.py", "test_wheel.py", "hockle/test_film.py",
)  # fmt: skip
"""The files that take longest, longest first: begun last, one of them would keep the others' processes waiting."""


def pytest_configure(config: pytest.Config) -> None:
    """Before tests run side by side, compile the kernels, each once: else each side does it.

    Tests start hundreds of processes. They compile no module twice, even where Python is told to write no bytecode.
    """
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    if hasattr(config, "workerinput") or not config.getoption("numprocesses", None):
        return
    load = "import solver; from solver.run.warming import load"
    compiling = [subprocess.Popen([sys.executable, "-c", f"{load}; {statement}"]) for statement in COMPILED]
    for process in compiling:
        process.wait()


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Look for no garbage while tests are collected: what is loaded stays, and to look takes a quarter of the time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Where files are dealt out to processes, they get those that take longest first."""
    if hasattr(config, "workerinput"):
        place = {Path(__file__).parent / name: number for number, name in enumerate(LONG)}
        items.sort(key=lambda item: place.get(item.path, len(LONG)))


@pytest.fixture
def until() -> Callable[[Callable[[], object], str], None]:
    """Wait until a condition holds, looking less often the longer it takes: most conditions ask a server, on the cores
    that what is waited for runs on. The bound only keeps a broken test from waiting forever."""

    def wait(condition: Callable[[], object], what: str = "") -> None:
        began = time.monotonic()
        while not condition():
            passed = time.monotonic() - began
            if passed > LONGEST:
                pytest.fail(f"did not come about within {LONGEST:.0f} s: {what}")
            time.sleep(min(0.01 + 0.03 * passed, 0.1))

    return wait


@pytest.fixture(scope="session")
def empty_registry(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A registry without jobs, as a file that nobody has open."""
    path = tmp_path_factory.mktemp("empty") / "registry.db"
    Database(f"sqlite:///{path}").close()
    return path


@pytest.fixture
def tables(tmp_path: Path, empty_registry: Path) -> None:
    """In `tmp_path` lies a registry without jobs: to copy one takes a fifth of what it takes to make its tables."""
    shutil.copy(empty_registry, tmp_path / "registry.db")


@pytest.fixture(scope="session")
def s3() -> Iterator[str]:
    """A server on loopback that speaks S3; gives its address."""
    from moto.server import ThreadedMotoServer  # it takes a second to load

    server = ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    server.start()
    yield "http://{}:{}".format(*server.get_host_and_port())
    server.stop()


@pytest.fixture
def objects(s3: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The address of an empty place in a bucket there."""
    import boto3

    for name, value in {"AWS_ENDPOINT_URL": s3, "AWS_ACCESS_KEY_ID": "x", "AWS_SECRET_ACCESS_KEY": "x",
                        "AWS_DEFAULT_REGION": "us-east-1", "AWS_CONFIG_FILE": "/nowhere"}.items():
        monkeypatch.setenv(name, value)
    bucket.client.cache_clear()
    name = f"hockle-{uuid4()}"
    boto3.client("s3").create_bucket(Bucket=name)
    yield f"s3://{name}/datasets"
    bucket.client.cache_clear()


@pytest.fixture
def held_objects(objects: str) -> Callable[[], list[str]]:
    """Gives the names of the objects that lie in that place now."""
    import boto3

    def names() -> list[str]:
        name = objects.split("/")[2]
        found = boto3.client("s3").list_objects_v2(Bucket=name).get("Contents", [])
        return [one["Key"].removeprefix("datasets/") for one in found]

    return names
