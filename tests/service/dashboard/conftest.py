"""The dashboard in a real browser: a server on loopback, headless Chromium."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from benchmarks.dashboard.browser import CHROMIUM, SPARING, browsing, serving
from service.cases import apply_settings, load_case, parse_case
from service.jobs import Database, NewJob, Registry
from service.jobs.registry import insert_jobs
from service.settings import Settings
from worker.run import run_next

CASE = parse_case(load_case("elastica")).document()


@pytest.fixture
def settings(tmp_path: Path, tables: None) -> Settings:
    return replace(Settings(data=tmp_path), rate=1e6, quota=20_000)


@pytest.fixture
def server(settings: Settings) -> Iterator[SimpleNamespace]:
    with serving(settings) as running:
        yield running


@pytest.fixture
def keyed_server(settings: Settings) -> Iterator[SimpleNamespace]:
    with serving(settings, keyed=True) as running:
        yield running


@pytest.fixture
def registry(server: SimpleNamespace) -> Registry:
    return server.app.state.parts.registry


@pytest.fixture
def add(registry: Registry) -> Callable[..., list[str]]:
    """Put jobs into the registry; gives their ids."""

    def jobs(many: int, title: str = "a rod", **more: str) -> list[str]:
        database: Database = registry.database
        ids: list[str] = []
        for start in range(0, many, 1000):
            new = [NewJob(CASE, title=f"{title} {k}", **more)
                   for k in range(start, min(start + 1000, many))]
            with database.writing() as transaction:
                ids += [job.id for job in insert_jobs(transaction, new)]
        return ids

    return jobs


@pytest.fixture
def run(registry: Registry, settings: Settings) -> Callable[..., str]:
    """Run a shipped case with some values set; gives the job's id."""

    def job(name: str, **values: object) -> str:
        spec = parse_case(apply_settings(load_case(name), {key.replace("__", "."): one for key, one in values.items()}))
        new = registry.submit(NewJob(spec.document(), title=spec.title))
        assert run_next(registry.database, settings)
        return new.id

    return job


@pytest.fixture(scope="module")
def opened() -> Iterator[Callable[[], Any]]:
    """A browser that the tests of a module share: gives what opens a page, with cookies and storage of its own."""
    if CHROMIUM is None:
        pytest.skip("there is no Chromium: apt-get install chromium")
    pytest.importorskip("playwright.sync_api", reason="Playwright's Python package is not installed")
    with browsing(*SPARING) as opened:
        yield opened


@pytest.fixture
def page(opened):
    """An empty page; no fault may be told on its console, and nothing asked for elsewhere."""
    page, faults = opened(), []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda line: faults.append(line.text) if "Content Security Policy" in line.text else None)
    page.on("request", lambda request: None if request.url.startswith(("http://127.0.0.1:", "data:", "blob:", "about:"))
            else faults.append(f"asked for {request.url}"))  # fmt: skip
    yield page
    page.context.close()
    assert faults == []
