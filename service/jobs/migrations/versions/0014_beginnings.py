"""Jobs that begin from the state of another one, and wait for its end."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"


def upgrade() -> None:
    """Add the columns; what was there before begins by itself."""
    op.add_column("jobs", sa.Column("begins_with", sa.String(26)))
    op.add_column("jobs", sa.Column("begins_at", sa.Integer, nullable=False, server_default="0"))
    op.add_column("jobs", sa.Column("waits", sa.Boolean, nullable=False, server_default=sa.false()))
    op.create_index("jobs_by_beginning", "jobs", ["begins_with"])
