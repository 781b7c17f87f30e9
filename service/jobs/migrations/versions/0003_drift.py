"""How far a run has drifted from what the physics keeps."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Add the columns; what ended before has none."""
    op.add_column("jobs", sa.Column("drift_method", sa.String(16)))
    op.add_column("jobs", sa.Column("drift_topology", sa.Double))
    op.add_column("jobs", sa.Column("drift_energy", sa.Double))
