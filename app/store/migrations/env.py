"""Run by alembic for every migration command; the connection comes from `app.store.migrate`."""

from alembic import context

from app.store.rows import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    transactional_ddl=True,
)
with context.begin_transaction():
    context.run_migrations()
