"""A table of blobs is the truth about files; what was known of files that no row refers to is found again."""

from pathlib import Path

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
_SIZED = (("photos", "blob"), ("capture_photos", "blob"), ("clips", "blob"), ("files", "blob"))
_OTHERS = (("model_parts", "blob"), ("solves", "structure"))


def upgrade() -> None:
    """Make the change."""
    op.create_table(
        "blobs",
        sa.Column("team", sa.String(length=40), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("bytes", sa.BigInteger(), nullable=False),
        sa.Column("created", sa.Float(), nullable=False),
        sa.Column("seen", sa.Float(), nullable=True),
        sa.PrimaryKeyConstraint("team", "sha256", name="pk_blobs"),
    )
    op.create_table(
        "upload_pieces",
        sa.Column("team", sa.String(length=40), server_default="local", nullable=False),
        sa.Column("upload", sa.String(length=40), nullable=False),
        sa.Column("start", sa.BigInteger(), nullable=False),
        sa.Column("bytes", sa.Integer(), nullable=False),
        sa.Column("blob", sa.String(length=64), nullable=False),
        sa.ForeignKeyConstraint(["upload"], ["uploads.id"], name="fk_upload_pieces_upload", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("upload", "start", name="pk_upload_pieces"),
    )
    op.create_index("ix_upload_pieces_blob", "upload_pieces", ["blob"])
    named = " UNION ALL ".join(
        [f"SELECT team, {column} AS name, bytes FROM {table}" for table, column in _SIZED]
        + [f"SELECT team, {column}, 0 FROM {table} WHERE {column} IS NOT NULL" for table, column in _OTHERS]
    )
    op.execute(
        "INSERT INTO blobs (team, sha256, bytes, created)"
        f" SELECT team, name, max(bytes), 0 FROM ({named}) AS named GROUP BY team, name"
    )
    if op.get_bind().dialect.name == "sqlite":
        _measure()
    op.drop_table("strays")


def _measure() -> None:
    """Set the sizes that no row tells by those of the files, which are in the data folder."""
    connection = op.get_bind()
    folder = Path(str(connection.engine.url.database)).parent / "blobs"
    for (name,) in connection.exec_driver_sql("SELECT sha256 FROM blobs WHERE bytes = 0").fetchall():
        path = folder / name[:2] / name
        if path.is_file():
            size = path.stat().st_size
            connection.execute(
                sa.text("UPDATE blobs SET bytes = :size WHERE sha256 = :name"), {"size": size, "name": name}
            )
