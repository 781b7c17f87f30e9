"""Hosts get a new version one by one while jobs run: what the old one began ends, and either answers for all jobs."""

from __future__ import annotations

import os
import shutil
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from importlib.metadata import version
from pathlib import Path

import httpx
import pytest
from sqlalchemy import text

import solver
from chaos.cases import digest, undisturbed
from hockle_client import Client
from service.cases import apply_settings
from service.jobs import Database, Registry, Status
from service.results import open_dataset

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes through /proc")

TREE = Path(solver.__file__).parents[1]
OLD, NEW = version("hockle"), "99.0"
METADATA = f"Metadata-Version: 2.1\nName: hockle\nVersion: {NEW}\n"
MIGRATION = '''"""What comes after all there is."""

import sqlalchemy as sa
from alembic import op

revision = "9999"
down_revision = "{before}"


def upgrade() -> None:
    """Add a column of which old processes know nothing, and an index on it."""
    op.add_column("jobs", sa.Column("later", sa.Integer, nullable=False, server_default="7"))
    op.create_index("jobs_by_later", "jobs", ["later", "id"])
'''


@pytest.fixture
def newer(tmp_path: Path) -> Path:
    """The packages of a later version, with one more migration.

    All but the solver, which is imported from where it is: one that lies elsewhere, though the same byte for byte, has
    its kernels compiled anew, and that takes a minute.
    """
    tree = tmp_path / "newer"
    for package in ("service", "worker", "hockle"):
        shutil.copytree(TREE / package, tree / package)
    versions = tree / "service" / "jobs" / "migrations" / "versions"
    before = max(versions.glob("[0-9]*.py")).name[:4]
    (versions / "9999_later.py").write_text(MIGRATION.format(before=before))
    told = tree / f"hockle-{NEW}.dist-info"
    told.mkdir()
    (told / "METADATA").write_text(METADATA)
    return tree


@pytest.fixture
def registry(postgresql) -> Iterator[Registry]:
    """The registry as a process of the old version sees it, which opened it before the upgrade."""
    database = Database(postgresql.url())
    yield Registry(database)
    database.close()


def schema(registry) -> str:
    with registry.database.reading() as connection:
        return connection.scalar(text("SELECT version_num FROM alembic_version"))


def said(server, path: str) -> dict:
    return httpx.get(f"{server.address}{path}", trust_env=False).raise_for_status().json()


def versions(*servers) -> list[str]:
    return [said(server, "/v1/openapi.json")["info"]["version"] for server in servers]


def listed(server) -> set[str]:
    return {job["id"] for job in said(server, "/v1/jobs")["jobs"]}


def process_of(job) -> int:
    """The id of the worker process that runs it."""
    return int(job.worker.split(":")[1])


def runs_on(server, job) -> bool:
    """Whether the job's worker is a process of the server."""
    return job.status is Status.RUNNING and process_of(job) in server.below()


@pytest.fixture
def held(registry, until) -> Callable[[str], AbstractContextManager[None]]:
    """`with held(job):` its worker process stands still: a short job outlasts what takes long. It is stopped while
    nobody is at the database, else a transaction of its own could keep the tables from being changed."""

    def others_at_work() -> bool:
        query = text("SELECT count(*) FROM pg_stat_activity WHERE pid <> pg_backend_pid() AND state <> 'idle'")
        with registry.database.reading() as connection:
            return connection.scalar(query) > 0

    def stopped(pid: int) -> bool:
        os.kill(pid, signal.SIGSTOP)
        if others_at_work():
            os.kill(pid, signal.SIGCONT)
            return False
        return True

    @contextmanager
    def hold(job_id: str) -> Iterator[None]:
        pid = process_of(registry.get(job_id))
        until(lambda: stopped(pid), "the job is held")
        try:
            yield
        finally:
            os.kill(pid, signal.SIGCONT)

    return hold


def end_of(client, job_id: str) -> tuple[str, int]:
    ended = client.job(job_id).wait().state
    return ended.status, ended.attempts


def fetched(client, job_id: str, path: Path) -> tuple[str, str]:
    """The version that a job's dataset names, and the digest of its values."""
    client.job(job_id).fetch(path)
    with open_dataset(path) as opened:
        return opened.attrs["hockle_version"], digest(path)


def test_hosts_are_upgraded_one_by_one_while_jobs_run(
    start, newer, registry, postgresql, broker, held, slow, quick, until, tmp_path
):
    slow = apply_settings(slow, {"t_end": 3.0, "numerics.dt_max": 0.001})
    no_lease_runs_out = {"HOCKLE_LEASE": "300"}
    shared = {"HOCKLE_STORE": str(tmp_path / "store"), "HOCKLE_DATABASE": postgresql.url(),
              "REDIS_URL": f"redis://127.0.0.1:{broker}/0"} | no_lease_runs_out  # fmt: skip
    upgraded = shared | {"tree": newer, "PYTHONPATH": os.pathsep.join([str(newer), str(TREE)])}
    once = ("successful", 1)

    def under_way(server, job_id: str) -> bool:
        job = registry.get(job_id)
        return runs_on(server, job) and job.progress > 0.02

    with ExitStack() as while_b_runs:
        with start(tmp_path / "a", **shared) as a, Client(a.address) as at_a:
            first = at_a.submit(slow).id
            until(lambda: under_way(a, first), "the old version runs a job")
            with held(first):
                b = while_b_runs.enter_context(start(tmp_path / "b", **upgraded))
                until(lambda: schema(registry) == "9999", "the new version has upgraded the tables")
                assert runs_on(a, registry.get(first))

                at_b = while_b_runs.enter_context(Client(b.address))
                assert versions(a, b) == [OLD, NEW]
                second = at_a.submit(slow, again=True).id
                until(lambda: under_way(b, second), "the other host, which is free, runs what the old version accepted")
            with held(second):
                assert end_of(at_a, first) == once
                third = at_a.submit(quick).id
                assert end_of(at_b, third) == once
                fourth = at_b.submit(slow, again=True).id
                until(lambda: under_way(a, fourth), "the old version, which is free, runs what the new one accepted")

        handed_back = registry.get(fourth).reached.steps
        assert [event.kind for event in registry.events(fourth)][:3] == ["accepted", "started", "handed_back"]
        assert [end_of(at_b, job_id) for job_id in (second, fourth)] == [once, once]
        assert registry.get(fourth).reached.steps_redone == 0 < handed_back

        with start(tmp_path / "a", **upgraded) as a, Client(a.address) as at_a:
            assert versions(a, b) == [NEW, NEW]
            last = {at_b.submit(quick, again=True).id, at_a.submit(quick, again=True).id}
            while_b_runs.close()
            last.add(at_a.submit(quick, again=True).id)
            assert {end_of(at_a, job_id) for job_id in last} == {once}
            assert listed(a) == {first, second, third, fourth} | last
            got = {job_id: fetched(at_a, job_id, tmp_path / f"{job_id}.nc") for job_id in listed(a)}
    same, short = undisturbed(slow), undisturbed(quick)
    assert got == {first: (OLD, same), second: (NEW, same), third: (OLD, short), fourth: (NEW, same)} | \
        dict.fromkeys(last, (NEW, short))  # fmt: skip
