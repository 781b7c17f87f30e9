"""JSON bodies, read strictly: bounded, UTF-8, finite numbers, no key twice."""

from __future__ import annotations

import json
import math
from typing import Any

from fastapi import Request

from service.api.problems import Problem

LARGEST_BODY = 1_000_000


async def json_object(request: Request) -> dict[str, Any]:
    """The object in the request's body. Raises Problem 400, 413 or 415."""
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type != "application/json":
        raise Problem(415, "not_json", f"Content-Type must be application/json, got {media_type!r}")
    told = parse(await _read(request))
    if not isinstance(told, dict):
        raise Problem(400, "not_an_object", f"the body must be a JSON object, got a {type(told).__name__}")
    return told


def parse(body: bytes) -> Any:
    """The value of strict JSON text. Raises Problem 400."""
    try:
        told = json.loads(body.decode(), parse_constant=_refuse, parse_float=_finite,
                          object_pairs_hook=_without_doubles)
        if b"\\u" in body:
            json.dumps(told, ensure_ascii=False).encode()  # half a surrogate pair is not text
    except RecursionError:
        raise Problem(400, "malformed_json", "the body is nested too deeply") from None
    except ValueError as error:  # of the text, of the JSON, of a number with too many digits
        raise Problem(400, "malformed_json", f"the body is not strict JSON: {error}"[:300]) from None
    return told


async def _read(request: Request) -> bytes:
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > LARGEST_BODY:
            raise Problem(413, "body_too_large", f"the body must be at most {LARGEST_BODY} bytes",
                          {"Connection": "close"})
    return bytes(body)


def _refuse(constant: str) -> float:
    raise ValueError(f"numbers must be finite, got {constant}")


def _finite(text: str) -> float:
    number = float(text)
    return number if math.isfinite(number) else _refuse(text)


def _without_doubles(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    told = dict(pairs)
    if len(told) < len(pairs):
        keys = [key for key, _ in pairs]
        raise ValueError(f"the key {next(k for k in keys if keys.count(k) > 1)!r} stands twice in one object")
    return told
