"""What is to be delivered: each end of a job to the address it was submitted with, until that says yes."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import select, update

from service.jobs import ENDED, Database
from service.jobs.tables import api_keys, jobs, webhooks

WAITS = (10.0, 60.0, 300.0, 1800.0, 7200.0, 21600.0)
"""How long (s) to wait after each try that failed; after the last one it is given up."""

HELD = 60.0
"""How long (s) a process that delivers may take before another tries."""


@dataclass(frozen=True)
class Delivery:
    """One end of a job, whom to tell of it, and with what to sign: the SHA-256 of the API key's secret (hex)."""

    job_id: str
    url: str
    secret_sha256: str
    status: str
    outcome: str
    tries: int


def take_due(database: Database, limit: int) -> list[Delivery]:
    """Deliveries that are due; no other process takes them for HELD seconds."""
    query = (
        select(webhooks.c.job_id, webhooks.c.url, api_keys.c.sha256, jobs.c.status, jobs.c.outcome, webhooks.c.tries)
        .join(jobs, jobs.c.id == webhooks.c.job_id).join(api_keys, api_keys.c.prefix == webhooks.c.key)
        .where(jobs.c.status.in_(ENDED)).order_by(webhooks.c.due).limit(limit)
    )  # fmt: skip
    with database.reading() as connection:
        if not connection.execute(query.where(webhooks.c.due.is_not(None)).limit(1)).first():
            return []
    with database.writing() as transaction:
        connection = transaction.connection
        due = webhooks.c.due <= transaction.now
        deliveries = [Delivery(*row) for row in connection.execute(query.where(due).with_for_update(of=webhooks))]
        taken = webhooks.c.job_id.in_([delivery.job_id for delivery in deliveries])
        connection.execute(update(webhooks).where(taken).values(due=transaction.now + HELD))
    return deliveries


def settle(database: Database, delivery: Delivery, answer: str, again: bool) -> None:
    """Write what came of a try: `again` if it failed and may be repeated."""
    wait = WAITS[delivery.tries] if again and delivery.tries < len(WAITS) else None
    with database.writing() as transaction:
        transaction.change(jobs.c.id == delivery.job_id)  # what its readers see is another from now on
        transaction.connection.execute(
            update(webhooks).where(webhooks.c.job_id == delivery.job_id)
            .values(tries=delivery.tries + 1, answer=answer, due=None if wait is None else transaction.now + wait)
        )  # fmt: skip
