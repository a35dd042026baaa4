"""``wildscav verify``: re-simulate records and compare every step."""

import os
from collections.abc import Callable, Sequence
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from wildscav.cli.json_option import AsJson
from wildscav.errors import UserError, describe

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_engine.record import Record


CHECKS = "wildscav.record_checks"  # entry points: functions such as RecordCheck
# Told a record's file, the record, and the public key that must have signed it, if any; returns what is wrong
# with it besides that it does not hold, nothing if nothing is.
RecordCheck = Callable[[Path, "Record", str | None], str]


class Finding(NamedTuple):
    """What was found out about one record."""

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
            help="The organizer's public key, 64 hexadecimal digits or a file with them: demand that it "
            "signed the records' evaluation.",
            metavar="PUBLIC",
            show_default=False,
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Play records again and compare every step. Exit code 0 only if all hold.

    A record that holds is a true account of its match: what every seat did, and what came of it. The names
    of the seats are not part of that. A record in an evaluation's folder must also be the one that the
    folder's ledger names; with --key, the organizer must have signed that ledger.
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
    everything = counted(len(records), "record")
    held = f"{len(records) - len(failed)} of {everything}"
    console.print(f"\n{held} {'holds' if len(records) - len(failed) == 1 else 'hold'}", highlight=False)
    if failed:
        more = f" (and {len(failed) - 1} more)" if len(failed) > 1 else ""
        raise UserError(
            f"{len(failed)} of {everything} {'does' if len(failed) == 1 else 'do'} not hold: "
            f"{failed[0].path}: {failed[0].message}{more}"
        )


def _table(findings: list[Finding]) -> "Table":
    """Return a line for each record, named without the folder that all are in."""
    from rich.text import Text

    from wildscav.terminal.console import printable
    from wildscav.terminal.tables import FittingTable

    common = os.path.commonpath([one.path.absolute().parent for one in findings])
    table = FittingTable()
    table.add_column("record", no_wrap=True)
    table.add_column("", no_wrap=True)
    table.add_column("what was found", min_width=24)
    for path, holds, message in findings:
        name = printable(str(path.absolute().relative_to(common)))
        verdict = Text("holds", "green") if holds else Text("FAILS", "bold red")
        table.add_row(Text(name, "" if holds else "bold"), verdict, Text(message))
    return table


def _checks(key: str | None) -> list[RecordCheck]:
    """Return what is asked of records besides that they hold, as other packages plug it in.

    Raises:
        UserError: A key is given, and nothing installed can check signatures.
    """
    found: list[RecordCheck] = []
    for point in entry_points(group=CHECKS):
        try:
            found.append(point.load())
        except ModuleNotFoundError:
            continue  # its extra was not asked for
    if key is not None and not found:
        raise UserError("--key needs the evaluator; install it with: pip install 'wildscav[evaluator]'", 2)
    return found


def _check(path: Path, checks: "Sequence[RecordCheck]", key: str | None) -> Finding:
    """Play a record again. Whatever is wrong with it, the others are still to be checked."""
    from wildscav.terminal.console import printable
    from wildscav_engine import ENGINE_VERSION
    from wildscav_engine.maps import GENERATOR_VERSION
    from wildscav_engine.record import RecordError, read_record, verify_record

    try:
        record = read_record(path)
        result = verify_record(record)
        objection = next(filter(None, (check(path, record, key) for check in checks)), "")
    except RecordError as error:
        return Finding(path, False, printable(str(error).removeprefix(f"{path}: ")))
    except OSError as error:
        return Finding(path, False, printable(describe(error)))
    except MemoryError:
        return Finding(path, False, "its match does not fit into this machine's memory")
    if result.holds and objection:
        return Finding(path, False, printable(objection))
    message = f"{record.steps} steps" if result.holds else result.message
    # A record of another generator says itself which engine made it.
    if record.engine_version != ENGINE_VERSION and record.generator_version == GENERATOR_VERSION:
        message += f" (recorded by engine {record.engine_version}; this one is {ENGINE_VERSION})"
    return Finding(path, result.holds, printable(message))
