"""Which server runs a job, and how often its process was killed."""

import sqlalchemy as sa
from alembic import op

from app.store.rows import UtcDateTime

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("jobs", sa.Column("kills", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("jobs", sa.Column("server", sa.String(32)))
    op.create_table(
        "servers",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("started_at", UtcDateTime(), nullable=False),
        sa.Column("seen_at", UtcDateTime(), nullable=False),
    )
