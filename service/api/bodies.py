"""JSON bodies, read strictly: bounded, UTF-8, finite numbers, no key twice."""

from __future__ import annotations

import asyncio
import json
import math
import re
from collections.abc import Callable
from typing import Any, TypeVar

from fastapi import Request

from service.api.problems import Problem
from service.cases.slips import Slip

Result = TypeVar("Result")
LARGEST_BODY = 1_000_000
SMALL_BODY = 10_000
"""Bytes that are understood within a few milliseconds."""
MOST_MEMBERS = 1000
"""Members of an object; a case has lists that are longer, but no object with half as many."""


async def json_object(request: Request) -> dict[str, Any]:
    """The object in the request's body. Raises Problem 400, 413 or 415."""
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type != "application/json":
        raise Problem(415, "not_json", f"Content-Type must be application/json, got {media_type!r}")
    body = await _read(request)
    value = await at_leisure(len(body), parse, body)
    request.state.body_size = len(body)
    if not isinstance(value, dict):
        raise Problem(400, "not_an_object", f"the body must be a JSON object, got a {type(value).__name__}")
    return value


async def at_leisure(size: int, work: Callable[..., Result], *parameters: Any) -> Result:
    """What `work` makes of a body of `size` bytes: at once if it is small, else in a thread, so that others are
    answered meanwhile."""
    return work(*parameters) if size <= SMALL_BODY else await asyncio.to_thread(work, *parameters)


def parse(body: bytes) -> Any:
    """The value of strict JSON text. Raises Problem 400."""
    try:
        text = body.decode()
        value = json.loads(text, parse_constant=_refuse, parse_float=_finite, object_pairs_hook=_without_doubles)
        if b"\\u" in body:
            json.dumps(value, ensure_ascii=False).encode()  # half a surrogate pair is not text
    except RecursionError:
        raise Problem(400, "malformed_json", "the body is nested too deeply") from None
    except (json.JSONDecodeError, _NotFinite) as error:
        slip = Slip.of(error.in_text(text) if isinstance(error, _NotFinite) else error)
        raise Problem(400, "malformed_json", f"the body is not strict JSON: {slip}: {slip.text.strip()!r}") from None
    except ValueError as error:  # of the text, of a number with too many digits
        raise Problem(400, "malformed_json", f"the body is not strict JSON: {error}"[:300]) from None
    return value


async def _read(request: Request) -> bytes:
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > LARGEST_BODY:
            raise Problem(413, "body_too_large", f"the body must be at most {LARGEST_BODY} bytes",
                          {"Connection": "close"})
    return bytes(body)


class _NotFinite(ValueError):
    """A number that is not finite, as it is written."""

    def in_text(self, text: str) -> json.JSONDecodeError:
        """The same with the place where it stands first, outside of texts."""
        number = re.escape(str(self))
        words = re.finditer(rf'"(?:\\.|[^"\\])*"|(?<![\w.+-]){number}(?![\w.])', text)
        at = next((word.start() for word in words if word[0][0] != '"'), 0)
        return json.JSONDecodeError(f"numbers must be finite, got {self}"[:100], text, at)


def _refuse(constant: str) -> float:
    raise _NotFinite(constant)


def _finite(text: str) -> float:
    number = float(text)
    return number if math.isfinite(number) else _refuse(text)


def _without_doubles(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    if len(pairs) > MOST_MEMBERS:
        raise ValueError(f"an object must have at most {MOST_MEMBERS} members, got {len(pairs)}")
    members: dict[str, Any] = {}
    for key, value in pairs:
        if key in members:
            raise ValueError(f"the key {key!r} stands twice in one object")
        members[key] = value
    return members
