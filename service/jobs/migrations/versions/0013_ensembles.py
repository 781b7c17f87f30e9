"""Ensembles and their members; the last values of a run's numbers, beside its job."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0010"


def upgrade() -> None:
    """Make the tables, and add the column; of what ended before, the dataset tells."""
    op.create_table(
        "ensembles",
        sa.Column("id", sa.String(26), primary_key=True),
        sa.Column("owner", sa.String(64), nullable=False),
        sa.Column("title", sa.Text, nullable=False),
        sa.Column("label", sa.Text, nullable=False),
        sa.Column("design", sa.Text, nullable=False),
        sa.Column("created", sa.Double, nullable=False),
        sa.Column("key", sa.String(255)),
        sa.Column("body_sha256", sa.String(64), nullable=False),
    )
    op.create_index("ensembles_by_owner", "ensembles", ["owner", "id"])
    op.create_index("ensembles_by_key", "ensembles", ["owner", "key"], unique=True)
    op.create_table(
        "members",
        sa.Column("ensemble_id", sa.String(26), sa.ForeignKey("ensembles.id", ondelete="CASCADE"), primary_key=True),
        sa.Column("number", sa.Integer, primary_key=True),
        sa.Column("job_id", sa.String(26), sa.ForeignKey("jobs.id"), nullable=False),
        sa.Column("values", sa.Text, nullable=False),
    )
    op.create_index("ix_members_job_id", "members", ["job_id"])
    op.add_column("jobs", sa.Column("scalars", sa.Text))
