"""``wildscav verify``: re-simulate records and compare every step."""

import os
from collections.abc import Callable, Sequence
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError, describe

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_engine.record import Record


CHECKS = "wildscav.record_checks"  # entry points: functions such as RecordCheck
# A further check of a record that holds. Its arguments are the record's file, the record, and the public key
# that must have signed it, if any. It returns what is wrong with the record, or "".
RecordCheck = Callable[[Path, "Record", str | None], str]


class Finding(NamedTuple):
    """The result of verifying one record."""

    path: Path
    holds: bool
    message: str  # one line, safe to print


def verify(
    records: Annotated[
        list[Path], typer.Argument(help="Record files.", metavar="RECORD…", show_default=False)
    ],
    key: Annotated[
        str | None,
        typer.Option(
            help="The organizer's public key, 64 hexadecimal digits or a file with them: require that it "
            "has signed the records' evaluation.",
            metavar="PUBLIC",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Play records again and compare every step. The exit code is 0 only if all records hold.

    A record that holds is a true account of its match: the actions of every seat, and their result. The names
    of the seats are not verified. A record in an evaluation's folder must also be the one that the folder's
    ledger names; with --key, the organizer must have signed that ledger. Whether any is missing, `wildscav
    rescore` tells.
    """
    from wildscav.terminal.console import console, counted, error_console, print_json

    checks = _checks(key)
    findings: list[Finding] = []
    with error_console.status("") as status:
        for path in records:
            status.update(f"re-simulating {len(findings) + 1} of {len(records)}")
            findings.append(_check(path, checks, key))
    console.print(_table(findings))
    if as_json:
        print_json({"records": [{**one._asdict(), "path": str(one.path)} for one in findings]})
    failed = [one for one in findings if not one.holds]
    total = counted(len(records), "record")
    held = f"{len(records) - len(failed)} of {total}"
    console.print(f"\n{held} {'holds' if len(records) - len(failed) == 1 else 'hold'}", highlight=False)
    if failed:
        more = f" (and {len(failed) - 1} more)" if len(failed) > 1 else ""
        raise UserError(
            f"{len(failed)} of {total} {'does' if len(failed) == 1 else 'do'} not hold: "
            f"{failed[0].path}: {failed[0].message}{more}"
        )


def _table(findings: list[Finding]) -> "Table":
    """Return a table with a row for each record, named without the folder that they share."""
    from rich.text import Text

    from wildscav.terminal.console import printable
    from wildscav.terminal.tables import FittingTable

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


def _checks(key: str | None) -> list[RecordCheck]:
    """Return the further checks of records that other packages register.

    Raises:
        UserError: A key is given, but nothing that is installed can check signatures.
    """
    found: list[RecordCheck] = []
    for point in entry_points(group=CHECKS):
        try:
            found.append(point.load())
        except ModuleNotFoundError:
            continue  # its extra is not installed
    if key is not None and not found:
        raise UserError("--key needs the evaluator; install it with: pip install 'wildscav[evaluator]'", 2)
    return found


def _check(path: Path, checks: "Sequence[RecordCheck]", key: str | None) -> Finding:
    """Play a record again. Errors become findings, because the other records are still to be checked."""
    from wildscav.terminal.console import printable
    from wildscav_engine import ENGINE_VERSION
    from wildscav_engine.maps import GENERATOR_VERSION
    from wildscav_engine.record import RecordError, read_record, verify_record

    try:
        record = read_record(path)
        result = verify_record(record)
        failure = next(filter(None, (check(path, record, key) for check in checks)), "")
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
