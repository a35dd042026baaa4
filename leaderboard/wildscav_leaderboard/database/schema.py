"""The version of a season's schema, and its upgrade to the current one."""

from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, inspect

from wildscav.errors import UserError

VERSION_TABLE = "season_version"


def bring_to(connection: Connection, version: str = "head") -> None:
    """Give an empty or older database of a season the schema of a version, in the open transaction."""
    command.upgrade(_config(connection), version)


def versions_known(connection: Connection) -> set[str]:
    """Return the versions of the schema that this Wildscav knows."""
    scripts = ScriptDirectory.from_config(_config(connection)).walk_revisions()
    return {script.revision for script in scripts}


def check_is_current(connection: Connection, name: str) -> None:
    """Check that a database has the current schema, without changing it.

    Raises:
        UserError: It has none, or an older or a newer one, or that of something else.
    """
    version, current = versions_of(connection, name)
    if version != current:
        raise UserError(f"{name} has no season of this version: `wildscav season serve` brings it up to date")


def versions_of(connection: Connection, name: str) -> tuple[str | None, str | None]:
    """Return the version of a database's schema, and the current one.

    Raises:
        UserError: It is a newer one, or that of something else.
    """
    check_known(connection, name)
    return version_of(connection), ScriptDirectory.from_config(_config(connection)).get_current_head()


def take_back_to(connection: Connection, version: str) -> None:
    """Give a database the schema of an older version, in the open transaction; ``base`` has no tables."""
    command.downgrade(_config(connection), version)


def version_of(connection: Connection) -> str | None:
    """Return the version of a database's schema; None if it has none of our tables."""
    context = MigrationContext.configure(connection, opts={"version_table": VERSION_TABLE})
    return context.get_current_revision()


def check_known(connection: Connection, name: str) -> None:
    """Refuse a database that has other tables than a season's, or those of a newer version.

    Raises:
        UserError: It is such a database.
    """
    version, tables = version_of(connection), inspect(connection).get_table_names()
    if version is None and set(tables) - {VERSION_TABLE}:
        raise UserError(f"{name} has tables of something else: a season needs a database of its own", 2)
    if version is not None and version not in versions_known(connection):
        raise UserError(f"{name} was written by a newer version of Wildscav", 2)


def _config(connection: Connection) -> Config:
    config = Config(attributes={"connection": connection})
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    return config
