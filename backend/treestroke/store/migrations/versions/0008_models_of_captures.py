"""Models that are made of captures: which capture, and parts that are named by its photos."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    """Make the change."""
    op.add_column("models", sa.Column("capture", sa.String(length=40), nullable=True))
    with op.batch_alter_table("model_parts") as table:
        table.alter_column("name", existing_type=sa.String(length=40), type_=sa.String(length=220))
