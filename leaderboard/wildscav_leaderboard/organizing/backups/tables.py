"""The content of a database as lines of JSON, a file for each table: the same for every kind of database.

The first line of a file names the columns, and each of the others is a row.
So a season that was backed up from SQLite can be restored into PostgreSQL, and the other way round.
"""

import json
from collections.abc import Iterator
from datetime import datetime
from itertools import islice
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, DateTime, MetaData, Table, inspect, select, text

from wildscav_leaderboard.database.schema import VERSION_TABLE

SUFFIX = ".ndjson"
AT_ONCE = 1000  # rows


def write_tables(connection: Connection, folder: Path) -> int:
    """Write all tables into a folder, as the transaction sees them; return how many rows there are."""
    rows = 0
    for table in _tables(connection):
        with (folder / f"{table.name}{SUFFIX}").open("w", encoding="utf-8") as file:
            file.write(f"{json.dumps([column.name for column in table.columns])}\n")
            ordered = select(table).order_by(*table.primary_key.columns)
            for row in connection.execute(ordered, execution_options={"yield_per": AT_ONCE}):
                file.write(f"{json.dumps(list(row), default=datetime.isoformat)}\n")
                rows += 1
    return rows


def read_tables(connection: Connection, folder: Path) -> int:
    """Fill the tables of an empty database that has the same schema; return how many rows there are."""
    rows = 0
    for table in _tables(connection):
        path = folder / f"{table.name}{SUFFIX}"
        for some in _batches(path, table):
            connection.execute(table.insert(), some)
            rows += len(some)
        if connection.dialect.name == "postgresql":
            _go_on_counting(connection, table)
    return rows


def is_empty(connection: Connection) -> bool:
    """Return whether a database has no tables, or only a season's tables without a row."""
    names = set(inspect(connection).get_table_names()) - {VERSION_TABLE}
    if names and VERSION_TABLE not in inspect(connection).get_table_names():
        return False
    return all(connection.execute(select(table).limit(1)).first() is None for table in _tables(connection))


def _tables(connection: Connection) -> list[Table]:
    """Return the season's tables; those that others refer to come before them."""
    found = MetaData()
    found.reflect(connection)
    return [table for table in found.sorted_tables if table.name != VERSION_TABLE]


def _batches(path: Path, table: Table) -> Iterator[list[dict[str, Any]]]:
    with path.open(encoding="utf-8") as file:
        names = json.loads(next(file))
        columns = [(name, isinstance(table.columns[name].type, DateTime)) for name in names]
        while lines := list(islice(file, AT_ONCE)):
            yield [_row(json.loads(line), columns) for line in lines]


def _row(values: list[Any], columns: list[tuple[str, bool]]) -> dict[str, Any]:
    """Return a row for the database; moments are stored in UTC without a time zone."""
    return {
        name: datetime.fromisoformat(value) if is_moment and value is not None else value
        for (name, is_moment), value in zip(columns, values, strict=True)
    }


def _go_on_counting(connection: Connection, table: Table) -> None:
    """Let PostgreSQL give new rows numbers after those that were filled in."""
    if "id" not in table.columns:
        return
    names = {"table": table.name}
    sequence = connection.scalar(text("SELECT pg_get_serial_sequence(:table, 'id')"), names)
    last = connection.scalar(select(table.c.id).order_by(table.c.id.desc()).limit(1))
    if sequence is not None and last is not None:
        connection.execute(text("SELECT setval(:sequence, :last)"), {"sequence": sequence, "last": last})
