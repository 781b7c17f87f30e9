"""What every route stands on: the running service, and who asks."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends, Request
from fastapi.openapi.models import HTTPBearer
from fastapi.security.base import SecurityBase

from service.access import Caller, KeyStore, Scope
from service.access.limits import RateLimit
from service.api.admitted import Admitted
from service.api.feed import Feed
from service.api.health import Health
from service.api.problems import Problem
from service.jobs import Registry
from service.jobs.doorbell import Doorbell
from service.jobs.submissions import Submissions
from service.results import Datasets
from service.settings import Settings


@dataclass(frozen=True)
class Parts:
    """What one running API is made of."""

    settings: Settings
    registry: Registry
    doorbell: Doorbell
    keys: KeyStore
    rate: RateLimit
    submissions: Submissions
    feed: Feed
    datasets: Datasets
    health: Health
    admitted: Admitted
    one_ensemble: asyncio.Lock = field(default_factory=asyncio.Lock)
    """Held by whose cases are understood: those of many at once would take gigabytes."""


class _With(SecurityBase):
    """Gives the caller whom the gate let in, if the key has this scope."""

    def __init__(self, scope: Scope) -> None:
        self.model = HTTPBearer(description="An API key: `hockle keys create`.")
        self.scheme_name = "API key"
        self._scope = scope

    async def __call__(self, request: Request) -> Caller:
        """Raises Problem 403."""
        caller: Caller = request.scope["caller"]
        if self._scope not in caller.scopes:
            raise Problem(403, "scope_missing", f"this needs a key with the scope {self._scope}, and that of "
                          f"{caller.owner} has {', '.join(sorted(caller.scopes))}")
        return caller


async def _parts(request: Request) -> Parts:
    parts: Parts = request.app.state.parts
    return parts


InParts = Annotated[Parts, Depends(_parts)]
Reader = Annotated[Caller, Depends(_With(Scope.READ))]
Submitter = Annotated[Caller, Depends(_With(Scope.SUBMIT))]
Operator = Annotated[Caller, Depends(_With(Scope.OPERATE))]


async def _visible_jobs(parts: InParts, caller: Reader) -> Registry:
    return parts.registry.of(caller.sees)


async def _own(parts: InParts, caller: Submitter) -> Registry:
    return parts.registry.of(caller.sees)


Jobs = Annotated[Registry, Depends(_visible_jobs)]
"""The jobs that the caller may see, for reading."""

OwnJobs = Annotated[Registry, Depends(_own)]
"""The same, for changing: an operator who may submit may cancel what others have submitted."""


def matches(request: Request, etag: str) -> bool:
    """Whether the client already has what `etag` names (If-None-Match)."""
    header = request.headers.get("if-none-match", "")
    return etag in [tag.strip().removeprefix("W/") for tag in header.split(",")] or header.strip() == "*"
