"""Who sends a request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from service.access.key import ApiKey, Scope, sha256, split
from service.jobs.audit import Actor
from service.jobs.job import LOCAL as LOCAL_OWNER

NOBODY = ApiKey("", "", frozenset(), sha256("nobody"), 0.0, 0.0)


class Refused(Exception):
    """The request names no key, or one that is not good."""


@dataclass(frozen=True)
class Caller:
    """An owner, what the owner may do, and the prefix of the key that said so (none on loopback)."""

    owner: str
    scopes: frozenset[Scope]
    key: str = ""

    @property
    def actor(self) -> Actor:
        """The caller as the audit trail names it."""
        return Actor(self.owner, self.key)

    @property
    def sees(self) -> str | None:
        """Whose jobs the caller may see; None: everybody's."""
        return None if Scope.OPERATE in self.scopes else self.owner


LOCAL = Caller(LOCAL_OWNER, frozenset(Scope))
"""Who asks from this machine without a key, where none is required."""


def authenticate(authorization: str | None, find: Callable[[str], ApiKey | None], required: bool,
                 now: float) -> Caller:
    """The caller that an Authorization header names.

    `find` gives the stored key of a prefix. Raises Refused for a header that is not a good key, and for
    none where a key is required. What was wrong with a key is not told: unknown, expired and revoked look the same.
    """
    if authorization is None:
        if required:
            raise Refused("an API key is required: send Authorization: Bearer hk_...")
        return LOCAL
    scheme, _, text = authorization.partition(" ")
    parts = split(text.strip())
    if scheme.lower() != "bearer" or parts is None:
        raise Refused("this is no API key: send Authorization: Bearer hk_..., as hockle keys create prints it")
    prefix, secret = parts
    key = find(prefix)
    if not (key or NOBODY).opens(secret, now) or key is None:
        raise Refused("this API key is not good: it is unknown, expired or revoked")
    return Caller(key.owner, key.scopes, key.prefix)
