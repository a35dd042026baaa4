"""The version of a database's schema, and its upgrade to the current one."""

from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, inspect

UNNUMBERED = "1"  # version of databases without a version number
FIRST_TABLES = {"submissions", "evaluations", "scores", "match_results"}  # of every version


def is_current(connection: Connection) -> bool:
    """Return whether a database has the current schema."""
    return _version(connection) == _scripts(_config(connection)).get_current_head()


def is_ours(connection: Connection) -> bool:
    """Return whether a database is a leaderboard's, of any version."""
    return set(inspect(connection).get_table_names()) >= FIRST_TABLES


def is_newer(connection: Connection) -> bool:
    """Return whether a database is of a newer, unknown version."""
    known = {script.revision for script in _scripts(_config(connection)).walk_revisions()}
    return is_ours(connection) and _version(connection) not in known


def bring_up_to_date(connection: Connection) -> None:
    """Give an empty or older database of ours the current schema, in the open transaction."""
    config = _config(connection)
    if _named_version(connection) is None and is_ours(connection):
        command.stamp(config, UNNUMBERED)
    command.upgrade(config, "head")


def _version(connection: Connection) -> str | None:
    """Return the version of a database; None if it is not ours."""
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
