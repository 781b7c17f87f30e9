"""Links: addresses by which anybody reads one dataset, for a time. Of a link's secret only its hash is kept."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sqlalchemy import insert, select, update

from service.access.key import sha256
from service.jobs import Database
from service.jobs.audit import Actor, note
from service.jobs.tables import links

ID = 12
"""Characters of a token that name its link; the others are its secret."""
NOBODYS = sha256("nobody")


@dataclass(frozen=True)
class Link:
    """A link as it is stored. Times are Unix seconds; `sha256` is that of the secret."""

    id: str
    job_id: str
    sha256: str = field(repr=False)
    created: float
    expires: float
    revoked: float | None = None


class LinkStore:
    """The links of one database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def create(self, job_id: str, actor: Actor, seconds: float) -> tuple[Link, str]:
        """A link to the dataset of a job, good for `seconds`, and its token, which is kept nowhere."""
        name, secret = secrets.token_hex(ID // 2), secrets.token_urlsafe(32)
        with self._database.writing() as transaction:
            link = Link(name, job_id, sha256(secret), transaction.now, transaction.now + seconds)
            transaction.connection.execute(insert(links), vars(link))
            note(transaction, actor, "link_created", job_id)
        return link, name + secret

    def opened(self, token: str, now: float) -> Link | None:
        """The link that a token opens at the time `now`, by a point read; None if it is not good."""
        name, secret = token[:ID], token[ID:]
        with self._database.reading() as connection:
            row = connection.execute(select(links).where(links.c.id == name)).mappings().first()
        link = None if row is None else _link(row)
        same = hmac.compare_digest(sha256(secret), link.sha256 if link else NOBODYS)
        return link if link and same and link.revoked is None and now < link.expires else None

    def of(self, job_id: str) -> list[Link]:
        """The links to a job's dataset, oldest first, those that are good no more included."""
        query = select(links).where(links.c.job_id == job_id).order_by(links.c.created, links.c.id)
        with self._database.reading() as connection:
            return [_link(row) for row in connection.execute(query).mappings()]

    def revoke(self, job_id: str, link_id: str, actor: Actor) -> bool:
        """Make a link useless from now on; whether the job has such a link."""
        with self._database.writing() as transaction:
            conditions = (links.c.job_id == job_id, links.c.id == link_id)
            good = update(links).where(*conditions, links.c.revoked.is_(None)).values(revoked=transaction.now)
            if transaction.connection.execute(good).rowcount:
                note(transaction, actor, "link_revoked", job_id)
                return True
            return transaction.connection.execute(select(links.c.id).where(*conditions)).first() is not None


def _link(row: Mapping[Any, Any]) -> Link:
    return Link(**row)
