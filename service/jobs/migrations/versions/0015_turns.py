"""Jobs that are to give way to others; pauses of the queue and of hosts, which the audit trail names."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"


def upgrade() -> None:
    """Add the column and the table; a host's name is longer than a job's id."""
    op.add_column("jobs", sa.Column("gives_way", sa.Boolean, nullable=False, server_default=sa.false()))
    op.create_table(
        "pauses",
        sa.Column("host", sa.String(64), primary_key=True),
        sa.Column("drains", sa.Boolean, nullable=False),
        sa.Column("since", sa.Double, nullable=False),
        sa.Column("owner", sa.String(64), nullable=False),
    )
    with op.batch_alter_table("audit") as table:
        table.alter_column("subject", existing_type=sa.String(26), type_=sa.String(64), existing_nullable=False)
