"""``wildscav verify``: re-simulate records and compare every step."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.errors import UserError, describe


def verify(
    records: Annotated[
        list[Path], typer.Argument(help="Record files.", metavar="RECORD…", show_default=False)
    ],
) -> None:
    """Play records again and compare every step. Exit code 0 only if all hold."""
    from rich.table import Column, Table

    from wildscav.console import console, error_console

    table = Table(Column("record", overflow="fold"), "holds", "first difference", "")
    failed: list[str] = []
    with error_console.status("re-simulating") as status:
        for path in records:
            status.update(f"re-simulating {path.name}")
            holds, step, message = _check(path)
            verdict = "[green]yes[/green]" if holds else "[red]no[/red]"
            table.add_row(str(path), verdict, "" if step is None else f"step {step}", message)
            if not holds:
                failed.append(f"{path}: {message}")
    console.print(table)
    if failed:
        more = f" (and {len(failed) - 1} more)" if len(failed) > 1 else ""
        raise UserError(f"{len(failed)} of {len(records)} records do not hold: {failed[0]}{more}")


def _check(path: Path) -> tuple[bool, int | None, str]:
    """Return whether a record holds, the first step that differs, and what else there is to say."""
    from wildscav_engine.record import RecordError, read_record, verify_record

    try:
        result = verify_record(read_record(path))
    except RecordError as error:
        return False, None, str(error).removeprefix(f"{path}: ")
    except OSError as error:
        return False, None, describe(error)
    return result.holds, result.step, result.message
