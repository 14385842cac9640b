"""Run migrations on the connection that the database hands in."""

from alembic import context

from treestroke.store import account_tables, webhook_tables  # noqa: F401 - their tables belong to the metadata
from treestroke.store.tables import Table

connection = context.config.attributes["connection"]
context.configure(connection=connection, target_metadata=Table.metadata, render_as_batch=True)
with context.begin_transaction():
    context.run_migrations()
