"""How many unfinished jobs each owner has, so that nobody counts them."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"

COUNT = """
UPDATE owners SET unfinished =
(SELECT count(*) FROM jobs WHERE jobs.owner = owners.name AND jobs.status IN ('accepted', 'running'))
"""


def upgrade() -> None:
    """Add the column, and count once."""
    op.add_column("owners", sa.Column("unfinished", sa.BigInteger, nullable=False, server_default="0"))
    op.execute(COUNT)
