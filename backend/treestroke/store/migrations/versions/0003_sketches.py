"""Models of sketches, which may have neither photo nor strokes."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Make the change."""
    with op.batch_alter_table("models") as models:
        models.alter_column("photo", existing_type=sa.String(length=40), nullable=True)
        for name in ("photo_blob", "strokes_blob"):
            models.alter_column(name, existing_type=sa.String(length=64), nullable=True)
        for name in ("front_blob", "side_blob", "fruit_blob"):
            models.add_column(sa.Column(name, sa.String(length=64), nullable=True))
        for name in ("front_ending", "side_ending"):
            models.add_column(sa.Column(name, sa.String(length=4), nullable=True))
