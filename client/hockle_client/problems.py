"""What can go wrong, as exceptions."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timezone
from email.utils import parsedate_to_datetime
from typing import Any

import httpx

PROBLEM = "application/problem+json"
URN = "urn:hockle:problem:"
TEMPORARY = (429, 502, 503, 504)
NEVER_BETTER = (httpx.UnsupportedProtocol, httpx.LocalProtocolError)


class HockleError(Exception):
    """Whatever the client raises. `temporary`: whether the same may succeed a little later."""

    temporary = False
    retry_after: float | None = None


class Unreachable(HockleError):
    """No server answers, or the connection broke."""

    def __init__(self, server: str, error: httpx.HTTPError) -> None:
        super().__init__(f"no hockle server answers at {server} ({error})")
        self.temporary = not isinstance(error, NEVER_BETTER)


class DamagedDataset(HockleError):
    """What arrived is not what the server has: its sha256 is another."""

    temporary = True


@dataclass(frozen=True)
class Fault:
    """One refused value: where (by `pointer` into the body, or a `parameter`), what it was, and the rule."""

    rule: str
    value: Any = None
    pointer: str | None = None
    parameter: str | None = None

    @property
    def place(self) -> str:
        """Where in the case, or in the query."""
        return (self.pointer or "").removeprefix("/case") or self.parameter or "the case"

    def __str__(self) -> str:
        fault = f"{self.place} {self.rule}"
        if self.value is None:
            return fault
        told, colon, question = fault.rpartition(": ") if fault.endswith("?") else (fault, "", "")
        return f"{told}, got {self.value!r}{colon}{question}"


class Problem(HockleError):
    """The server said no (RFC 9457).

    `name` is the end of its type, such as invalid_case; `errors` the values that it refuses; `retry_after` in how many
    seconds to ask again; `document` all that it said.
    """

    def __init__(self, status: int, document: dict[str, Any], retry_after: float | None = None) -> None:
        self.status, self.document, self.retry_after = status, document, retry_after
        self.type = str(document.get("type", "about:blank"))
        self.title = str(document.get("title", ""))
        self.detail = str(document.get("detail", ""))
        fields = ("rule", "value", "pointer", "parameter")
        self.errors = [Fault(**{name: fault[name] for name in fields if name in fault})
                       for fault in document.get("errors") or []]  # fmt: skip
        super().__init__(self._text())

    @property
    def name(self) -> str:
        """What kind of problem it is, in a word."""
        return self.type.removeprefix(URN)

    @property
    def temporary(self) -> bool:  # type: ignore[override]
        """Whether the server is busy or away, not against it."""
        return self.status in TEMPORARY or self.name == "in_flight"

    def _text(self) -> str:
        lines = [f"  {fault}" for fault in self.errors]
        return "\n".join(["the server refused this:", *lines]) if lines else self.detail


def problem_of(response: httpx.Response) -> Problem:
    """The problem in an answer, whose body must have been read."""
    document: Any = None
    if response.headers.get("content-type", "").partition(";")[0] == PROBLEM:
        document = response.json()
    if not isinstance(document, dict):
        document = {"title": response.reason_phrase,
                    "detail": f"the server answered {response.status_code} {response.reason_phrase}"}
    return Problem(response.status_code, document, seconds_of(response.headers.get("retry-after")))


def seconds_of(retry_after: str | None) -> float | None:
    """A Retry-After header in seconds from now: it is a number of them, or a date."""
    if retry_after is None:
        return None
    if retry_after.strip().isdigit():
        return float(retry_after)
    try:
        date = parsedate_to_datetime(retry_after)
    except ValueError:
        return None
    return max(0.0, (date - datetime.now(timezone.utc)).total_seconds())
