"""A model's own picture of a leaf."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Make the change."""
    op.add_column("models", sa.Column("leaf_blob", sa.String(length=64), nullable=True))
