"""hockle keys: who may use a service that others can reach."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from hockle.failure import Failure
from hockle.here import add_data, registry_of, settings_of

if TYPE_CHECKING:
    from service.access import KeyStore

DAY = 86400.0
MOST_DAYS = 3650
SCOPES = ("read", "submit", "operate")


def register(subparsers: Any) -> None:
    """Add `hockle keys create`, `hockle keys list` and `hockle keys revoke`."""
    keys = subparsers.add_parser("keys", help="API keys of the service whose data lie here")
    below = keys.add_subparsers(required=True, metavar="COMMAND")
    creating = below.add_parser("create", help="make a key and print it, this once")
    creating.add_argument("owner", metavar="OWNER", help="whose jobs are submitted and seen with it")
    creating.add_argument("--scopes", default="read,submit", help="some of read, submit, operate (default read,submit)")
    creating.add_argument("--days", type=float, default=365.0, help="how long it is good (default 365)")
    creating.set_defaults(run=create)
    listing = below.add_parser("list", help="every key, without its secret")
    listing.set_defaults(run=list_keys)
    revoking = below.add_parser("revoke", help="make a key useless from now on")
    revoking.add_argument("prefix", metavar="PREFIX", help="as `list` shows it")
    revoking.set_defaults(run=revoke)
    add_data(creating, listing, revoking)


def create(arguments: argparse.Namespace) -> int:
    """Make a key and print its text."""
    from service.access import Scope

    scopes = arguments.scopes.split(",")
    unknown = [name for name in scopes if name not in SCOPES]
    if unknown:
        raise Failure(f"--scopes takes some of {', '.join(SCOPES)}, got {unknown[0]!r}")
    if not 0 < arguments.days <= MOST_DAYS:
        raise Failure(f"--days must be > 0 and at most {MOST_DAYS}, got {arguments.days:g}")
    with _store(arguments) as store:
        try:
            new = store.create(arguments.owner, frozenset(map(Scope, scopes)), arguments.days * DAY)
        except ValueError as error:
            raise Failure(str(error)) from None
    print(new.text)
    return 0


def list_keys(arguments: argparse.Namespace) -> int:
    """Print every key: prefix, owner, scopes, expiry, state."""
    with _store(arguments) as store:
        now = datetime.now(UTC)
        for key in store.all():
            expires = datetime.fromtimestamp(key.expires, UTC)
            state = "revoked" if key.revoked is not None else "expired" if expires <= now else "good"
            print(f"{key.prefix}  {key.owner:20}  {','.join(sorted(key.scopes)):20}  {expires:%Y-%m-%d}  {state}")
    return 0


def revoke(arguments: argparse.Namespace) -> int:
    """Make a key useless."""
    from service.access import UnknownKey

    with _store(arguments) as store:
        try:
            store.revoke(arguments.prefix)
        except UnknownKey:
            raise Failure(f"no key has the prefix {arguments.prefix!r}: see hockle keys list") from None
    return 0


@contextmanager
def _store(arguments: argparse.Namespace) -> Iterator[KeyStore]:
    from service.access import KeyStore

    with registry_of(settings_of(arguments)) as database:
        yield KeyStore(database)
