"""``wildscav doctor``: which sandboxes keep their promises on this machine, and what to install."""

from dataclasses import asdict
from typing import TYPE_CHECKING

from wildscav.cli.json_option import AsJson
from wildscav.errors import UserError

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_evaluator.sandbox import Promise


def doctor(as_json: AsJson = False) -> None:
    """Try every promise of every sandbox on this machine; say which are kept, and what to install."""
    from rich.text import Text

    from wildscav.terminal.console import console, print_json
    from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES

    whole, sandboxes = [], []
    for name, sandbox in SANDBOXES.items():
        if not sandbox.isolated:
            continue
        with console.status(f"trying {name}"):
            promises = sandbox.promises(DEFAULT_LIMITS)
        console.print(_table(f"{name}{_engine(name)}", promises))
        sandboxes.append({"name": name, "promises": [asdict(promise) for promise in promises]})
        if all(promise.kept for promise in promises):
            whole.append(name)
    if as_json:
        print_json({"sandboxes": sandboxes, "default": whole[0] if whole else None})
    console.print(
        Text.assemble(("process", "bold"), " promises nothing: for agents that you would run yourself.")
    )
    if not whole:
        raise UserError("no sandbox keeps all its promises here: agents would run as plain processes")
    console.print(Text.assemble("Unless you say otherwise, agents run in ", (whole[0], "bold"), "."))


def _engine(sandbox: str) -> str:
    """Return the engine of a sandbox in brackets, if it has one here."""
    from wildscav_evaluator.sandbox import SandboxError
    from wildscav_evaluator.sandbox.containers.container_engine import find_engine

    try:
        return f" ({find_engine().name})" if sandbox == "oci" else ""
    except SandboxError:
        return ""


def _table(name: str, promises: "tuple[Promise, ...]") -> "Table":
    from rich.text import Text

    from wildscav_evaluator.cli.result_tables.ranking import plain_table

    kept = sum(promise.kept for promise in promises)
    title = f"{name}: {kept} of {len(promises)} promises kept"
    table = plain_table(title)
    for heading in ("promise", "", "found", "what to do"):
        table.add_column(heading)
    for promise in promises:
        mark = Text("kept", "green") if promise.kept else Text("broken", "red")
        table.add_row(promise.name, mark, promise.found, promise.remedy)
    return table
