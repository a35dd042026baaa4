"""The version of a database's schema, and the way from an older one to today's."""

from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, inspect

from wildscav_leaderboard.models import Base

UNNUMBERED = "1"  # version of the databases that do not name theirs


def is_current(connection: Connection) -> bool:
    """Return whether a database has today's schema."""
    return _version(connection) == _scripts(_config(connection)).get_current_head()


def is_ours(connection: Connection) -> bool:
    """Return whether a database is a leaderboard's, of whatever version."""
    return set(Base.metadata.tables) <= set(inspect(connection).get_table_names())


def is_newer(connection: Connection) -> bool:
    """Return whether a database is of a version that is not known here."""
    known = {script.revision for script in _scripts(_config(connection)).walk_revisions()}
    return is_ours(connection) and _version(connection) not in known


def bring_up_to_date(connection: Connection) -> None:
    """Give an empty database, or ours of an older version, today's schema, in the open transaction."""
    config = _config(connection)
    if _named_version(connection) is None and is_ours(connection):
        command.stamp(config, UNNUMBERED)
    command.upgrade(config, "head")


def _version(connection: Connection) -> str | None:
    """Return the version of a database; none if it is not ours."""
    named = _named_version(connection)
    return UNNUMBERED if named is None and is_ours(connection) else named


def _named_version(connection: Connection) -> str | None:
    return MigrationContext.configure(connection).get_current_revision()


def _config(connection: Connection) -> Config:
    config = Config(attributes={"connection": connection})
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    return config


def _scripts(config: Config) -> ScriptDirectory:
    return ScriptDirectory.from_config(config)
