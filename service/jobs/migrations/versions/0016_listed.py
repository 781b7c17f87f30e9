"""A list of everybody's jobs is read in order, without sorting all that are not deleted for each page."""

from __future__ import annotations

from alembic import op

revision = "0016"
down_revision = "0015"


def upgrade() -> None:
    """Add the index."""
    op.create_index("jobs_listed", "jobs", ["deleted", "id"])
