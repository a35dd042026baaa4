"""What ``wildscav doctor`` shows of this machine, or of the nodes of a cluster."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict

from rich.table import Table
from rich.text import Text

from wildscav.cli.main import GROUP as COMMANDS
from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json
from wildscav_engine.extensions import BUILT_IN, PREFIX, Addition, Registry, loaded, other_groups
from wildscav_evaluator.cli.result_tables import plain_table
from wildscav_evaluator.cli.sessions.verify_records import AUDITS
from wildscav_evaluator.executors import EXECUTORS, Examined, Executor
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES, Promise, SandboxError
from wildscav_evaluator.sandbox.containers.container_engine import find_engine
from wildscav_evaluator.suites.suite import SUITES


def examine_nodes(executor: Executor, *, as_json: bool = False) -> None:
    """Show which nodes of a cluster can be used, and which sandboxes work on each; UserError if none can."""
    names = [name for name in SANDBOXES.built_in if SANDBOXES[name].isolated]
    with console.status("trying sandboxes on all nodes"):
        nodes = executor.examine(names)
    console.print(nodes_table(nodes, names))
    if as_json:
        print_json({"nodes": [asdict(node) for node in nodes]})
    if not any(not node.problem and not all(node.sandboxes.values()) for node in nodes):
        raise UserError("no node of the cluster can run agents in a sandbox")


def nodes_table(nodes: Sequence[Examined], sandboxes: Sequence[str]) -> Table:
    """Return a table of the nodes, with the sandboxes that work on each."""
    table = plain_table("nodes of the cluster")
    for heading in ("node", "cores", *sandboxes, "what is wrong"):
        table.add_column(heading, justify="right" if heading == "cores" else "left")
    for node in nodes:
        broken = [f"{name}: {why}" for name, why in node.sandboxes.items() if why]
        if node.problem:
            marks = [Text("not used", "red") for _ in sandboxes]
        else:
            marks = [_works(not node.sandboxes[name]) for name in sandboxes]
        table.add_row(node.name, str(node.cores), *marks, Text(node.problem or "; ".join(broken)))
    return table


def _works(works: object, yes: str = "works") -> Text:
    return Text(yes, "green") if works else Text("broken", "red")


def examine_this_machine(*, as_json: bool) -> None:
    """Show which sandboxes keep their promises on this machine, and what other packages add.

    UserError if no sandbox keeps all its promises, or an addition does not work.
    """
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
        console.print(_promises_table(f"{name}{_engine(name)}", promises))
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
    try:
        return f" ({find_engine().name})" if SANDBOXES[sandbox].runs_images else ""
    except SandboxError:
        return ""


def _promises_table(name: str, promises: tuple[Promise, ...]) -> Table:
    kept = sum(promise.kept for promise in promises)
    title = f"{name}: {kept} of {len(promises)} promises kept"
    table = plain_table(title)
    for heading in ("promise", "", "found", "what to do"):
        table.add_column(heading)
    for promise in promises:
        table.add_row(promise.name, _works(promise.kept, "kept"), promise.found, promise.remedy)
    return table


def installed() -> Iterator[Addition]:
    """Yield what other packages add, each tried by importing it."""
    registries: list[Registry[object]] = [*map(Registry, BUILT_IN), SANDBOXES, SUITES, EXECUTORS]  # type: ignore[list-item]
    plain = (COMMANDS, AUDITS)
    for registry in registries:
        yield from registry.additions()
    for group in plain:
        yield from loaded(group)
    yield from other_groups({*plain, *(registry.group for registry in registries)})


def extensions_table(additions: list[Addition]) -> Table:
    """Return a table of what other packages add."""
    table = plain_table("added by other packages")
    for heading in ("kind", "name", "package", "", "why"):
        table.add_column(heading)
    for one in additions:
        kind, works = one.group.removeprefix(PREFIX), _works(not one.problem)
        table.add_row(kind, one.name, str(one.origin), works, Text(one.problem))
    return table
