"""Indexes by which quotas are counted."""

from alembic import op

revision = "0014"
down_revision = "0013"
_UPLOADED = ("photos", "capture_photos", "clips")


def upgrade() -> None:
    """Make the change."""
    for table in _UPLOADED:
        op.drop_index(f"ix_{table}_stored", table)
        op.create_index(f"ix_{table}_stored", table, ["team", "blob", "bytes"])
    op.create_index("ix_files_team", "files", ["team", "bytes"])
    op.create_index("ix_models_day", "models", ["team", "created"])
