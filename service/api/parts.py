"""What every route stands on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from service.jobs import Registry
from service.jobs.doorbell import Doorbell
from service.settings import Settings


@dataclass(frozen=True)
class Parts:
    """The settings, the registry and the doorbell of one running API."""

    settings: Settings
    registry: Registry
    doorbell: Doorbell


def _parts(request: Request) -> Parts:
    parts: Parts = request.app.state.parts
    return parts


InParts = Annotated[Parts, Depends(_parts)]


def matches(request: Request, etag: str) -> bool:
    """Whether the client already has what `etag` names (If-None-Match)."""
    told = request.headers.get("if-none-match", "")
    return etag in [tag.strip().removeprefix("W/") for tag in told.split(",")] or told.strip() == "*"
