"""The parts that models are made of get a table of their own, in place of columns of models."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
_PARTS = ("photo", "strokes", "front", "side", "leaf", "fruit")
_SKETCHES = ("front", "side")
_JSON, _PNG = "application/json", "image/png"


def upgrade() -> None:
    """Make the change."""
    op.create_table(
        "model_parts",
        sa.Column("model", sa.String(length=40), nullable=False),
        sa.Column("name", sa.String(length=40), nullable=False),
        sa.Column("blob", sa.String(length=64), nullable=False),
        sa.Column("media_type", sa.String(length=40), nullable=False),
        sa.ForeignKeyConstraint(["model"], ["models.id"], name="fk_model_parts_model", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("model", "name", name="pk_model_parts"),
    )
    for part in _PARTS:
        _copy(part)
        op.drop_index(f"ix_models_{part}_blob", "models")
    op.create_index("ix_model_parts_blob", "model_parts", ["blob"])
    op.drop_index("ix_models_twins", "models")
    with op.batch_alter_table("models") as models:
        for part in _PARTS:
            models.drop_column(f"{part}_blob")
        for part in _SKETCHES:
            models.drop_column(f"{part}_ending")
    op.create_index("ix_models_fingerprint", "models", ["fingerprint", "engine", "status"])


def _copy(part: str) -> None:
    """Copy a part of all models that have it; a sketch's ending tells its media type, a photo is stored as PNG."""
    usual = _JSON if part == "strokes" else _PNG
    media_type = (
        f"CASE {part}_ending WHEN 'png' THEN '{_PNG}' ELSE '{_JSON}' END" if part in _SKETCHES else f"'{usual}'"
    )
    op.execute(
        "INSERT INTO model_parts (model, name, blob, media_type) "
        f"SELECT id, '{part}', {part}_blob, {media_type} FROM models WHERE {part}_blob IS NOT NULL"
    )
