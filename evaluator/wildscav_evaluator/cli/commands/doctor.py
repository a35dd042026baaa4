"""``wildscav doctor``: which sandboxes keep their promises on this machine, and which extensions work."""

from dataclasses import asdict
from typing import TYPE_CHECKING

from wildscav.cli.json_option import AsJson
from wildscav.errors import UserError
from wildscav_evaluator.cli.options.executor import AddressOption, ExecutorOption, executor_of

if TYPE_CHECKING:
    from rich.table import Table

    from wildscav_evaluator.sandbox import Promise


def doctor(
    executor: ExecutorOption = "local", address: AddressOption = None, as_json: AsJson = False
) -> None:
    """Test every promise of every sandbox on this machine, and everything that other packages add.

    With --executor ray, test the nodes of a cluster instead: which can be used, and the sandboxes there.
    """
    with executor_of(executor, address) as machines:
        if machines.name != "local":
            from wildscav_evaluator.cli.sessions.doctor import examine_nodes

            examine_nodes(machines, as_json=as_json)
        else:
            _examine_this_machine(as_json=as_json)


def _examine_this_machine(*, as_json: bool) -> None:
    from rich.text import Text

    from wildscav.terminal.console import console, print_json
    from wildscav_evaluator.cli.result_tables.extensions import extensions_table, installed
    from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES

    additions = list(installed())
    broken = [one for one in additions if one.problem]
    added = [one.name for one in additions if one.group == SANDBOXES.group and not one.problem]
    complete, sandboxes = [], []
    for name in (*SANDBOXES.built_in, *added):
        sandbox = SANDBOXES[name]
        if not sandbox.isolated:
            continue
        with console.status(f"trying {name}"):
            promises = sandbox.promises(DEFAULT_LIMITS)
        console.print(_table(f"{name}{_engine(name)}", promises))
        sandboxes.append({"name": name, "promises": [asdict(promise) for promise in promises]})
        if name in SANDBOXES.built_in and all(promise.kept for promise in promises):
            complete.append(name)
    if additions:
        console.print(extensions_table(additions))
    if as_json:
        default = complete[0] if complete else None
        extensions = [{**one._asdict(), "origin": one.origin._asdict()} for one in additions]
        print_json({"sandboxes": sandboxes, "default": default, "extensions": extensions})
    console.print(
        Text.assemble(("process", "bold"), " promises nothing: use it only for agents that you trust.")
    )
    if broken:
        raise UserError("; ".join(one.problem for one in broken))
    if not complete:
        raise UserError("no sandbox keeps all its promises here: agents would run as plain processes")
    console.print(Text.assemble("By default, agents run in ", (complete[0], "bold"), "."))


def _engine(sandbox: str) -> str:
    """Return the container engine of a sandbox in brackets, or an empty text if it has none here."""
    from wildscav_evaluator.sandbox import SANDBOXES, SandboxError
    from wildscav_evaluator.sandbox.containers.container_engine import find_engine

    try:
        return f" ({find_engine().name})" if SANDBOXES[sandbox].runs_images else ""
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
