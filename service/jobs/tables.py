"""The registry's tables. A change of them needs a migration; a test compares the two."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from typing import Any

from sqlalchemy import (
    BigInteger,
    Boolean,
    Column,
    ColumnDefault,
    Double,
    ForeignKey,
    Index,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    select,
)

from service.jobs.job import Dataset, Job, Limits, Reached, Webhook
from service.jobs.lifecycle import Status

metadata = MetaData()

jobs = Table(
    "jobs",
    metadata,
    Column("id", String(26), primary_key=True),
    Column("owner", String(64), nullable=False),
    Column("status", String(10), nullable=False),
    Column("title", Text, nullable=False),
    Column("label", Text, nullable=False),
    Column("priority", Integer, nullable=False),
    Column("case_json", Text, nullable=False),
    Column("case_sha256", String(64), nullable=False),
    Column("progress", Double, nullable=False, default=0.0),
    Column("t", Double, nullable=False, default=0.0),
    Column("steps", BigInteger, nullable=False, default=0),
    Column("steps_redone", BigInteger, nullable=False, default=0),
    Column("wall", Double, nullable=False, default=0.0),
    Column("phase", Text, nullable=False, default=""),
    Column("outcome", String(64), nullable=False, default=""),
    Column("message", Text, nullable=False, default=""),
    Column("cancel_requested", Boolean, nullable=False, default=False),
    Column("gives_way", Boolean, nullable=False, default=False),
    Column("created", Double, nullable=False),
    Column("started", Double),
    Column("finished", Double),
    Column("attempts", Integer, nullable=False, default=0),
    Column("fruitless", Integer, nullable=False, default=0),
    Column("checkpoint_steps", BigInteger, nullable=False, default=0),
    Column("epoch", Integer, nullable=False, default=0),
    Column("lease_until", Double),
    Column("version", BigInteger, nullable=False, default=1),
    Column("worker", Text, nullable=False, default=""),
    Column("limit_wall", Double, nullable=False),
    Column("limit_memory", BigInteger, nullable=False),
    Column("limit_disk", BigInteger, nullable=False),
    Column("dataset_file", Text),
    Column("dataset_sha256", String(64)),
    Column("dataset_bytes", BigInteger),
    Column("attributes", Text, nullable=False, default="{}"),
    Column("scalars", Text),  # last values as JSON; none where only the dataset tells them
    Column("begins_with", String(26)),  # the job from whose state, at the frame `begins_at`, this one may begin
    Column("begins_at", Integer, nullable=False, default=0),
    Column("waits", Boolean, nullable=False, default=False),  # for the end of that job
    Column("drift_method", String(16)),
    Column("drift_topology", Double),
    Column("drift_energy", Double),
    Column("pinned", Boolean, nullable=False, default=False),
    Column("deleted", Double),
    Column("deleted_by", String(64), nullable=False, default=""),
    Column("dataset_stamp", String(80), nullable=False, default=""),
    Column("dataset_fault", Text, nullable=False, default=""),
    Index("jobs_by_status", "status", "id"),
    Index("jobs_by_owner", "owner", "id"),
    Index("jobs_by_case", "case_sha256", "status"),
    Index("jobs_by_beginning", "begins_with"),
    Index("jobs_in_turn", "status", "owner", "priority", "id"),
    Index("jobs_by_end", "deleted", "finished"),
    Index("jobs_by_bytes", "owner", "dataset_bytes"),
    Index("jobs_listed", "deleted", "id"),
)

owners = Table(
    "owners",  # all who ever submitted a job; `served` orders their latest claims, `unfinished` counts their jobs,
    # `bytes` is the size of their datasets
    metadata,
    Column("name", String(64), primary_key=True),
    Column("served", BigInteger, nullable=False, default=0),
    Column("unfinished", BigInteger, nullable=False, default=0),
    Column("bytes", BigInteger, nullable=False, default=0),
)

events = Table(
    "events",  # what happened to a job; `seq` is the job's version after it
    metadata,
    Column("job_id", String(26), ForeignKey("jobs.id"), primary_key=True),
    Column("seq", BigInteger, primary_key=True),
    Column("time", Double, nullable=False),
    Column("kind", String(32), nullable=False),
    Column("data", Text, nullable=False),
)

removals = Table(
    "removals",  # datasets of deleted jobs: their files are to be removed
    metadata,
    Column("file", Text, primary_key=True),
)

idempotency_keys = Table(
    "idempotency_keys",
    metadata,
    Column("owner", String(64), primary_key=True),
    Column("key", String(255), primary_key=True),
    Column("body_sha256", String(64), nullable=False),
    Column("job_id", String(26), ForeignKey("jobs.id"), nullable=False),
    Column("created", Double, nullable=False, index=True),
)

api_keys = Table(
    "api_keys",  # who may use the service; of a secret only its hash is kept
    metadata,
    Column("prefix", String(12), primary_key=True),
    Column("owner", String(64), nullable=False),
    Column("scopes", String(80), nullable=False),
    Column("sha256", String(64), nullable=False),
    Column("created", Double, nullable=False),
    Column("expires", Double, nullable=False),
    Column("revoked", Double),
)

ensembles = Table(
    "ensembles",  # jobs that were handed in together; `design` says of which values, as JSON
    metadata,
    Column("id", String(26), primary_key=True),
    Column("owner", String(64), nullable=False),
    Column("title", Text, nullable=False),
    Column("label", Text, nullable=False),
    Column("design", Text, nullable=False),
    Column("created", Double, nullable=False),
    Column("key", String(255)),
    Column("body_sha256", String(64), nullable=False),
    Index("ensembles_by_owner", "owner", "id"),
    Index("ensembles_by_key", "owner", "key", unique=True),
)

members = Table(
    "members",  # `values`, as JSON, are in the order of the design's parameters; equal members have one job
    metadata,
    Column("ensemble_id", String(26), ForeignKey("ensembles.id", ondelete="CASCADE"), primary_key=True),
    Column("number", Integer, primary_key=True),
    Column("job_id", String(26), ForeignKey("jobs.id"), nullable=False, index=True),
    Column("values", Text, nullable=False),
)

links = Table(
    "links",  # by which a dataset is read without a key; of a secret only its hash is kept
    metadata,
    Column("id", String(12), primary_key=True),
    Column("job_id", String(26), ForeignKey("jobs.id", ondelete="CASCADE"), nullable=False, index=True),
    Column("sha256", String(64), nullable=False),
    Column("created", Double, nullable=False),
    Column("expires", Double, nullable=False),
    Column("revoked", Double),
)

audit = Table(
    "audit",  # who did what; rows are only ever added
    metadata,
    Column("id", BigInteger().with_variant(Integer, "sqlite"), primary_key=True, autoincrement=True),
    Column("time", Double, nullable=False),
    Column("owner", String(64), nullable=False),
    Column("key", String(12), nullable=False),
    Column("action", String(32), nullable=False),
    Column("subject", String(64), nullable=False),
)

webhooks = Table(
    "webhooks",  # whom to tell of a job's end; `due` is the time of the next try, none after the last
    metadata,
    Column("job_id", String(26), ForeignKey("jobs.id"), primary_key=True),
    Column("url", Text, nullable=False),
    Column("key", String(12), ForeignKey("api_keys.prefix"), nullable=False),
    Column("tries", Integer, nullable=False, default=0),
    Column("due", Double, index=True),
    Column("answer", Text, nullable=False, default=""),
)

leader = Table(
    "leader",  # one row: who reconciles, and how often he has renewed his lease
    metadata,
    Column("name", String(16), primary_key=True),
    Column("holder", String(32), nullable=False, default=""),
    Column("beat", BigInteger, nullable=False, default=0),
)

pauses = Table(
    "pauses",  # of a host's workers, or of all (host empty): none takes a job; if it `drains`, none goes on with one
    metadata,
    Column("host", String(64), primary_key=True),
    Column("drains", Boolean, nullable=False),
    Column("since", Double, nullable=False),
    Column("owner", String(64), nullable=False),
)

processes = Table(
    "processes",  # those that run now; `beat` grows while one gets on, `stuck` names parts of it that do not
    metadata,
    Column("id", Text, primary_key=True),
    Column("kind", String(8), nullable=False),
    Column("host", Text, nullable=False),
    Column("pid", Integer, nullable=False),
    Column("beat", BigInteger, nullable=False),
    Column("seen", Double, nullable=False),
    Column("stuck", Text, nullable=False),
)

DATASET = tuple(field.name for field in dataclasses.fields(Dataset))
REACHED = tuple(field.name for field in dataclasses.fields(Reached))
NOT_OF_THE_JOB = ("case_json", "gives_way", "scalars", "waits", "checkpoint_steps", "drift_method", "drift_topology",
                  "drift_energy")  # fmt: skip
JOB_COLUMNS = [column for column in jobs.columns if column.name not in NOT_OF_THE_JOB]
FRESH = {column.name: column.default.arg if isinstance(column.default, ColumnDefault) else None
         for column in JOB_COLUMNS}  # fmt: skip
"""What a job's row holds where nothing was written."""


WEBHOOK = tuple(field.name for field in dataclasses.fields(Webhook))
JOBS = select(*JOB_COLUMNS, *(webhooks.c[name].label(f"webhook_{name}") for name in WEBHOOK)).outerjoin_from(
    jobs, webhooks)
"""Reads jobs with what became of their webhooks."""


def job_of(row: Mapping[Any, Any]) -> Job:
    """The job that a row of JOBS tells of, or of JOB_COLUMNS alone."""
    fields = dict(row)
    reached = Reached(*(fields.pop(name) for name in REACHED))
    limits = Limits(*(fields.pop(f"limit_{name}") for name in ("wall", "memory", "disk")))
    published = [fields.pop(f"dataset_{name}") for name in DATASET]
    dataset = Dataset(*published) if published[0] is not None else None
    hook = [fields.pop(f"webhook_{name}", None) for name in WEBHOOK]
    webhook = Webhook(*hook) if hook[0] is not None else None
    return Job(**fields | {"status": Status(fields["status"]), "reached": reached, "limits": limits,
                           "dataset": dataset, "webhook": webhook, "attributes": json.loads(fields["attributes"])})
