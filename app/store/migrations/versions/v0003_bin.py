"""Deleted resources stay, with the moment and what they were deleted with, until they are restored."""

import sqlalchemy as sa
from alembic import op

from app.store.rows import UtcDateTime

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("resources", sa.Column("deleted_at", UtcDateTime()))
    op.add_column("resources", sa.Column("deleted_with", sa.String(32)))
