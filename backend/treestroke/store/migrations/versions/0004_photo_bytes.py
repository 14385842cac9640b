"""How many bytes each photo keeps, and what was mended when it was read."""

from pathlib import Path

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Make the change."""
    op.add_column(
        "photos",
        sa.Column("bytes", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), server_default="0", nullable=False),
    )
    op.add_column("photos", sa.Column("warnings", sa.JSON(none_as_null=True), server_default="[]", nullable=False))
    _measure()


def _measure() -> None:
    """Count the photos that are kept already; one whose file is missing counts as nothing."""
    connection = op.get_bind()
    photos = sa.table("photos", sa.column("blob"), sa.column("bytes"))
    blobs = Path(str(connection.engine.url.database)).parent / "blobs"
    for (blob,) in connection.execute(sa.select(photos.c.blob).distinct()).all():
        path = blobs / blob[:2] / blob
        if path.is_file():
            connection.execute(photos.update().where(photos.c.blob == blob).values(bytes=path.stat().st_size))
