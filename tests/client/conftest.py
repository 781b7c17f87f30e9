"""The client beside a real service, and without await: the same tests hold for both of its kinds."""

from __future__ import annotations

import asyncio
import inspect
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from hockle_client import AsyncClient, AsyncEnsemble, AsyncJob, Case, Client
from tests.hockle.conftest import Server, serving

QUICK = {"t_end": 0.3, "output.interval": 0.1, "numerics.intervals": 20}
SLOW = {"t_end": 3.0, "output.interval": 0.1, "numerics.dt_max": 0.0005}


class Blocking:
    """What has to be awaited, called as what has not."""

    def __init__(self, inner: Any, run: asyncio.Runner) -> None:
        self.inner, self.run = inner, run

    def __getattr__(self, name: str) -> Any:
        told = getattr(self.inner, name)
        return partial(self._call, told) if callable(told) else told

    def _call(self, method: Any, *arguments: Any, **named: Any) -> Any:
        plain = [[one.inner for one in told] if isinstance(told, list) and told and isinstance(told[0], Blocking)
                 else told for told in arguments]  # fmt: skip
        told = method(*plain, **named)
        return self._each(told) if inspect.isasyncgen(told) else self._wrapped(self.run.run(told))

    def _each(self, told: Any) -> Iterator[Any]:
        while True:
            try:
                yield self._wrapped(self.run.run(anext(told)))
            except StopAsyncIteration:
                return

    def _wrapped(self, told: Any) -> Any:
        if isinstance(told, (AsyncJob, AsyncEnsemble)):
            return Blocking(told, self.run)
        return [self._wrapped(one) for one in told] if isinstance(told, list) else told


KINDS = ("sync", "async")


@contextmanager
def connecting(kind: str) -> Iterator[Any]:
    """`connect(url, ...)` is a client of that kind; they are closed at the end."""
    runner = asyncio.Runner()
    opened: list[Any] = []

    def make(*told: Any, **named: Any) -> Any:
        one = Client(*told, **named) if kind == "sync" else Blocking(AsyncClient(*told, **named), runner)
        opened.append(one)
        return one

    yield make
    for one in opened:
        one.close() if kind == "sync" else one.aclose()
    runner.close()


@pytest.fixture(params=KINDS)
def connect(request: pytest.FixtureRequest) -> Iterator[Any]:
    """`connect(url, ...)` is a client of either kind."""
    with connecting(request.param) as connect:
        yield connect


@pytest.fixture(scope="module")
def server(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server that the tests of a module share; the module may say of how many processes its API is."""
    with serving(tmp_path_factory.mktemp("data"), apis=getattr(request.module, "APIS", 1)) as server:
        assert server.address, server.first_line + server.process.stdout.read()
        yield server


@pytest.fixture
def client(connect, server: Server) -> Any:
    return connect(server.address)


def fresh(settings: dict[str, Any]) -> Case:
    return Case.shipped("goyal-2003").with_settings({**settings, "description": secrets.token_hex()})


@pytest.fixture
def quick() -> Case:
    """A case of a moment, which nobody has run before."""
    return fresh(QUICK)


@pytest.fixture
def slow() -> Case:
    """A case of some seconds, which nobody has run before."""
    return fresh(SLOW)


@pytest.fixture
def page() -> str:
    return (Path(__file__).parents[2] / "docs" / "client.md").read_text()
