"""A season's database as the first version stored it."""

import json
from hashlib import blake2b
from typing import Any

from sqlalchemy import Connection, create_engine, text

from wildscav_leaderboard.database.schema import take_back_to

SINCE_EDITIONS = ("suite_digest", "mode", "seats", "robots")  # in the conditions of boards and results


def take_back_to_first(url: str) -> None:
    """Give a season's database, which is SQLite, the first schema with what the first version stored."""
    engine = create_engine(url)
    with engine.connect() as connection:
        connection.connection.cursor().execute("PRAGMA foreign_keys = OFF")  # tables are copied
        with connection.begin():
            take_back_to(connection, "1")
            _write_conditions(connection)
            connection.execute(
                text("DELETE FROM season_state WHERE name = 'editions' OR name LIKE 'board:%'")
            )
    engine.dispose()


def _write_conditions(connection: Connection) -> None:
    """Write the conditions of boards and results without what they have had since there are editions."""
    for track, document in connection.execute(text("SELECT DISTINCT track, document FROM boards")).all():
        board = json.loads(document)
        new = _digest(board["conditions"])
        for name in SINCE_EDITIONS:
            del board["conditions"][name]
        values = {"track": track, "document": json.dumps(board), "new": new}
        values["old"] = _digest(board["conditions"])
        connection.execute(text("UPDATE boards SET document = :document WHERE track = :track"), values)
        for table in ("match_results", "ladder_steps"):
            changed = f"UPDATE {table} SET conditions = :old WHERE conditions = :new"  # noqa: S608
            connection.execute(text(changed), values)


def _digest(conditions: dict[str, Any]) -> str:
    written = json.dumps(conditions, separators=(",", ":")).encode()
    return blake2b(written, digest_size=16).hexdigest()
