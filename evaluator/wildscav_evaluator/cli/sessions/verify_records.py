"""What ``wildscav verify`` does and shows for records: each is played again, and every step compared."""

import os
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from rich.table import Table
from rich.text import Text

from wildscav.errors import UserError, describe
from wildscav.terminal.console import console, counted, error_console, print_json, printable
from wildscav.terminal.tables import FittingTable
from wildscav_engine import ENGINE_VERSION
from wildscav_engine.maps import GENERATOR_VERSION
from wildscav_engine.record import Record, RecordError, read_record, verify_record
from wildscav_evaluator.ledger.ledger import Ledger, LedgerError, check_key, read_ledger, sha256_of
from wildscav_evaluator.output.layout import LEDGER_FILE, RECORDS
from wildscav_evaluator.output.record_names import misnamed, parse_name

AUDITS = "wildscav.season_audits"  # entry points: functions that audit the season at a place


class Finding(NamedTuple):
    """The result of verifying one record."""

    path: Path
    holds: bool
    message: str  # one line, safe to print


def verify_records(records: Sequence[Path], key: str | None = None, *, as_json: bool = False) -> None:
    """Play records again, compare every step, and show a table of what was found.

    One in an evaluation's folder must also be the one that its ledger names; ``key`` is the public key that
    must have signed that ledger, None for any. UserError, after everything was shown, if one does not hold.
    """
    findings: list[Finding] = []
    with error_console.status("") as status:
        for path in records:
            status.update(f"re-simulating {len(findings) + 1} of {len(records)}")
            findings.append(_check(path, key))
    console.print(_table(findings))
    if as_json:
        print_json({"records": [{**one._asdict(), "path": str(one.path)} for one in findings]})
    failed = [one for one in findings if not one.holds]
    total = counted(len(records), "record")
    held = f"{len(records) - len(failed)} of {total}"
    console.print(f"\n{held} {'holds' if len(records) - len(failed) == 1 else 'hold'}")
    if failed:
        more = f" (and {len(failed) - 1} more)" if len(failed) > 1 else ""
        raise UserError(
            f"{len(failed)} of {total} {'does' if len(failed) == 1 else 'do'} not hold: "
            f"{failed[0].path}: {failed[0].message}{more}"
        )


def _table(findings: list[Finding]) -> Table:
    """Return a table with a row for each record, named without the folder that they share."""
    common = os.path.commonpath([one.path.absolute().parent for one in findings])
    table = FittingTable()
    table.add_column("record", no_wrap=True)
    table.add_column("", no_wrap=True)
    table.add_column("finding", min_width=24)
    for path, holds, message in findings:
        name = printable(str(path.absolute().relative_to(common)))
        verdict = Text("holds", "green") if holds else Text("FAILS", "bold red")
        table.add_row(Text(name, "" if holds else "bold"), verdict, Text(message))
    return table


def _check(path: Path, key: str | None) -> Finding:
    """Play a record again. Errors become findings, because the other records are still to be checked."""
    try:
        record = read_record(path)
        result = verify_record(record)
        failure = _contradiction(path, record, key)
    except RecordError as error:
        return Finding(path, False, printable(str(error).removeprefix(f"{path}: ")))
    except OSError as error:
        return Finding(path, False, printable(describe(error)))
    except MemoryError:
        return Finding(path, False, "its match does not fit into this machine's memory")
    if result.holds and failure:
        return Finding(path, False, printable(failure))
    message = f"{record.steps} steps" if result.holds else result.message
    # The message for a record of another generator names its engine already.
    if record.engine_version != ENGINE_VERSION and record.generator_version == GENERATOR_VERSION:
        message += f" (recorded by engine {record.engine_version}; this one is {ENGINE_VERSION})"
    return Finding(path, result.holds, printable(message))


def _contradiction(path: Path, record: Record, key: str | None) -> str:
    """Return why a record does not match its name or its evaluation's ledger, or an empty text if it does."""
    name = parse_name(path)
    if name is not None and (fault := misnamed(record, name)):
        return f"its file has the name of another record: {fault}"
    out = path.absolute().parent.parent
    try:
        ledger = _ledger(out) if path.absolute().parent.name == RECORDS else None
        if key is not None:
            check_key(ledger, _public(key), out)
    except LedgerError as error:
        return str(error)
    if ledger is None:
        return ""
    entered = ledger.played.get(path.stem)
    if entered is None:
        return f"{LEDGER_FILE} has no such match"
    return "" if entered.record == sha256_of(path) else f"{LEDGER_FILE} has the digest of another record"


@lru_cache(maxsize=1)
def _ledger(out: Path) -> Ledger | None:
    return read_ledger(out)


@lru_cache(maxsize=1)
def _public(key: str) -> str:
    from wildscav_evaluator.ledger.keys import read_public

    return read_public(key)
