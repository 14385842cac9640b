"""Files of some models are found by model, also where all files of their team have an index."""

from alembic import op

revision = "0018"
down_revision = "0017"


def upgrade() -> None:
    """Make the change."""
    op.drop_index("ix_files_team", "files")
    op.create_index("ix_files_team", "files", ["team", "model", "bytes"])
