"""The API keys in the registry's database."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sqlalchemy import exists, insert, select, update

from service.access.key import ApiKey, NewKey, Scope, sha256
from service.jobs import Database
from service.jobs.audit import CONSOLE, note
from service.jobs.tables import api_keys


class UnknownKey(Exception):
    """No key has this prefix."""


class KeyStore:
    """The keys of one database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def create(self, owner: str, scopes: frozenset[Scope], seconds: float) -> NewKey:
        """Store a key that is good for `seconds`; its text is in what is returned, and nowhere else."""
        with self._database.writing() as transaction:
            new = NewKey(owner, scopes, transaction.now + seconds)
            transaction.connection.execute(insert(api_keys), {
                "prefix": new.prefix, "owner": owner, "scopes": ",".join(sorted(scopes)),
                "sha256": sha256(new.secret), "created": transaction.now, "expires": new.expires,
            })
            note(transaction, CONSOLE, "key_created", new.prefix)
        return new

    def find(self, prefix: str) -> ApiKey | None:
        """The key with this prefix, good or not, by a point read."""
        with self._database.reading() as connection:
            row = connection.execute(select(api_keys).where(api_keys.c.prefix == prefix)).mappings().first()
        return None if row is None else _key(row)

    def all(self) -> list[ApiKey]:
        """Every key, oldest first."""
        with self._database.reading() as connection:
            return [_key(row) for row in connection.execute(select(api_keys).order_by(api_keys.c.created)).mappings()]

    def any_good(self, now: float) -> bool:
        """Whether at the time `now` somebody could use the service with a key."""
        good = exists().where(api_keys.c.revoked.is_(None), api_keys.c.expires > now)
        with self._database.reading() as connection:
            return bool(connection.scalar(select(good)))

    def revoke(self, prefix: str) -> None:
        """Make a key useless from now on. Raises UnknownKey."""
        with self._database.writing() as transaction:
            statement = update(api_keys).where(api_keys.c.prefix == prefix, api_keys.c.revoked.is_(None))
            if transaction.connection.execute(statement.values(revoked=transaction.now)).rowcount:
                note(transaction, CONSOLE, "key_revoked", prefix)
                return
        if self.find(prefix) is None:
            raise UnknownKey(prefix)


def _key(row: Mapping[Any, Any]) -> ApiKey:
    return ApiKey(**dict(row) | {"scopes": frozenset(map(Scope, row["scopes"].split(",")))})
