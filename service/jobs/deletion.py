"""What is deleted, and by whom. Of a deleted job stays who deleted it and when, and what the metrics count."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection

from sqlalchemy import delete, insert, select, update

from service.jobs.audit import Actor, note
from service.jobs.database import Database, Transaction
from service.jobs.lifecycle import ENDED
from service.jobs.tables import events, jobs, links, owners, removals, webhooks

BLANK = {"title": "", "label": "", "message": "", "case_json": "", "case_sha256": "", "attributes": "{}",
         "dataset_file": None, "dataset_sha256": None, "dataset_bytes": None, "dataset_stamp": "", "dataset_fault": "",
         "scalars": None}


def delete_jobs(transaction: Transaction, actor: Actor, job_ids: Collection[str]) -> list[str]:
    """Delete those of some jobs that have ended and are not pinned, and give their ids.

    Their cases, events, links and webhooks go at once; the files of their datasets are noted as removals.
    """
    connection = transaction.connection
    conditions = (jobs.c.id.in_(job_ids), jobs.c.status.in_(ENDED), jobs.c.deleted.is_(None), ~jobs.c.pinned)
    query = select(jobs.c.id, jobs.c.owner, jobs.c.dataset_file, jobs.c.dataset_bytes).where(*conditions)
    rows = connection.execute(query.order_by(jobs.c.id).with_for_update()).all()
    ids = [row.id for row in rows]
    if not ids:
        return []
    for table in (events, links, webhooks):
        connection.execute(delete(table).where(table.c.job_id.in_(ids)))
    marks = {"deleted": transaction.now, "deleted_by": actor.owner, "version": jobs.c.version + 1}
    connection.execute(update(jobs).where(jobs.c.id.in_(ids)).values(**BLANK, **marks))
    if files := [{"file": row.dataset_file} for row in rows if row.dataset_file is not None]:
        connection.execute(insert(removals), files)
    freed = Counter[str]()
    for row in rows:
        freed[row.owner] += row.dataset_bytes or 0
    for owner, bytes_ in sorted(freed.items()):  # in one order: rows are locked in it
        connection.execute(update(owners).where(owners.c.name == owner).values(bytes=owners.c.bytes - bytes_))
    note(transaction, actor, "job_deleted", *ids)
    return ids


def pending_removals(database: Database, limit: int) -> list[str]:
    """Some files that are to be removed."""
    with database.reading() as connection:
        return list(connection.scalars(select(removals.c.file).limit(limit)))


def removed(database: Database, files: Collection[str]) -> None:
    """Forget files that have been removed."""
    with database.writing() as transaction:
        transaction.connection.execute(delete(removals).where(removals.c.file.in_(files)))
