"""An API key: hk_PREFIX_SECRET. The prefix names it, the secret of 256 bits is stored as its SHA-256 only."""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
from dataclasses import dataclass, field
from enum import StrEnum

OWNER = re.compile(r"[a-z0-9][a-z0-9._-]{0,62}")
SPELLING = re.compile(r"hk_([0-9a-f]{12})_([A-Za-z0-9_-]{43})")
RESERVED = ("local", "console", "retention")


class Scope(StrEnum):
    """What a key is good for."""

    READ = "read"  # see one's own jobs and datasets
    SUBMIT = "submit"  # hand in, validate and cancel one's own jobs
    OPERATE = "operate"  # see every owner's jobs, the metrics and the audit trail


@dataclass(frozen=True)
class ApiKey:
    """A key as it is stored. Times are Unix seconds; `sha256` is that of the secret."""

    prefix: str
    owner: str
    scopes: frozenset[Scope]
    sha256: str = field(repr=False)
    created: float
    expires: float
    revoked: float | None = None

    def opens(self, secret: str, now: float) -> bool:
        """Whether `secret` is this key's and the key is good at the time `now`; as slow for a wrong one."""
        same = hmac.compare_digest(sha256(secret), self.sha256)
        return same and self.is_good(now)

    def is_good(self, now: float) -> bool:
        """Whether it was not revoked, and has not expired at the time `now`."""
        return self.revoked is None and now < self.expires


@dataclass(frozen=True)
class NewKey:
    """A key that is about to be stored: its text is shown once, and kept by nobody."""

    owner: str
    scopes: frozenset[Scope]
    expires: float
    prefix: str = field(default_factory=lambda: secrets.token_hex(6))
    secret: str = field(default_factory=lambda: secrets.token_urlsafe(32), repr=False)

    def __post_init__(self) -> None:
        if not OWNER.fullmatch(self.owner) or self.owner in RESERVED:
            raise ValueError(f"owner must be 1 to 63 of a-z 0-9 . _ -, and none of {', '.join(RESERVED)}, "
                             f"got {self.owner!r}")
        if not self.scopes:
            raise ValueError(f"scopes must be some of {', '.join(Scope)}, got none")

    @property
    def text(self) -> str:
        """What the owner sends with each request."""
        return f"hk_{self.prefix}_{self.secret}"


def split(text: str) -> tuple[str, str] | None:
    """Prefix and secret of a key's text; None if it is not one."""
    match = SPELLING.fullmatch(text)
    return (match[1], match[2]) if match else None


def sha256(secret: str) -> str:
    """The hash under which a secret is stored; with 256 random bits it needs no salt and no slowness."""
    return hashlib.sha256(secret.encode()).hexdigest()
