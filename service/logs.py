"""Logs as JSON, one object a line, to standard error."""

from __future__ import annotations

import json
import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import Any

USUAL = frozenset(vars(logging.makeLogRecord({}))) | {"message", "asctime", "taskName", "color_message"}
_context: dict[str, Any] = {}


@contextmanager
def about(**fields: Any) -> Iterator[None]:
    """Add these fields to every line that this process writes while the block runs: a worker has one job at a time."""
    _context.update(fields)
    try:
        yield
    finally:
        for name in fields:
            _context.pop(name, None)


class Json(logging.Formatter):
    """Time (UTC), level, logger and message; what `about` and `extra` add; the exception, if there is one."""

    def format(self, record: logging.LogRecord) -> str:
        """One line."""
        entry = {"time": datetime.fromtimestamp(record.created, UTC).isoformat(), "level": record.levelname.lower(),
                 "logger": record.name, "message": record.getMessage(), **_context}  # fmt: skip
        entry |= {name: value for name, value in vars(record).items() if name not in USUAL}
        if record.exc_info:
            entry["exception"] = self.formatException(record.exc_info)
        return json.dumps(entry, default=str)


def write_json(level: int = logging.INFO) -> None:
    """Send all logs of this process to standard error as JSON."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(Json())
    logging.root.handlers[:] = [handler]
    logging.root.setLevel(level)
    for noisy in ("httpx", "httpcore", "alembic", "numba"):
        logging.getLogger(noisy).setLevel(logging.WARNING)
