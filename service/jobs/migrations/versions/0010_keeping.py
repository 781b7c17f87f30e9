"""Jobs that are kept or deleted: pins, who deleted what, datasets that are known to be good or bad, bytes of owners."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0007"

COUNT = """
UPDATE owners SET bytes =
coalesce((SELECT sum(dataset_bytes) FROM jobs WHERE jobs.owner = owners.name), 0)
"""


def upgrade() -> None:
    """Add the columns and the table, and count once."""
    op.add_column("jobs", sa.Column("pinned", sa.Boolean, nullable=False, server_default=sa.false()))
    op.add_column("jobs", sa.Column("deleted", sa.Double))
    op.add_column("jobs", sa.Column("deleted_by", sa.String(64), nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("dataset_stamp", sa.String(80), nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("dataset_fault", sa.Text, nullable=False, server_default=""))
    op.create_index("jobs_by_end", "jobs", ["deleted", "finished"])
    op.create_index("jobs_by_bytes", "jobs", ["owner", "dataset_bytes"])
    op.add_column("owners", sa.Column("bytes", sa.BigInteger, nullable=False, server_default="0"))
    op.execute(COUNT)
    op.create_table("removals", sa.Column("file", sa.Text, primary_key=True))
