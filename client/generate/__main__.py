"""`make client`: write hockle_client/schema.py from the schema of cases, synchronous.py, jobs.py and
ensembles.py from those with await."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from generate.schema import types_of
from generate.sync import without_await
from service.cases import case_schema

HERE = Path(__file__).parent.parent / "hockle_client"


def _synchronous(source: str) -> str:
    return without_await(source, (HERE / source).read_text(encoding="utf-8"))


WRITTEN: dict[str, Callable[[], str]] = {
    "schema.py": lambda: types_of(case_schema()),
    "synchronous.py": lambda: _synchronous("asynchronous.py"),
    "jobs.py": lambda: _synchronous("async_jobs.py"),
    "ensembles.py": lambda: _synchronous("async_ensembles.py"),
}

if __name__ == "__main__":
    for name, write in WRITTEN.items():
        (HERE / name).write_text(write(), encoding="utf-8")
