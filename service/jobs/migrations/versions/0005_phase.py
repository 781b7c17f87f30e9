"""What a running job is doing, and what its run says of itself as a whole."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the columns; what ended before says nothing."""
    op.add_column("jobs", sa.Column("phase", sa.Text, nullable=False, server_default=""))
    op.add_column("jobs", sa.Column("attributes", sa.Text, nullable=False, server_default="{}"))
