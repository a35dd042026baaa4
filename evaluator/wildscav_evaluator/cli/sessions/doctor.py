"""What ``wildscav doctor`` shows of the nodes of a cluster."""

from collections.abc import Sequence
from dataclasses import asdict

from rich.table import Table
from rich.text import Text

from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json
from wildscav_evaluator.cli.result_tables.ranking import plain_table
from wildscav_evaluator.executors import Examined, Executor
from wildscav_evaluator.sandbox import SANDBOXES


def examine_nodes(executor: Executor, *, as_json: bool = False) -> None:
    """Show which nodes of a cluster can be used, and which sandboxes work on each.

    Raises:
        UserError: No node can run agents in a sandbox.
    """
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
        marks = [_mark(node, name) for name in sandboxes]
        table.add_row(node.name, str(node.cores), *marks, Text(node.problem or "; ".join(broken)))
    return table


def _mark(node: Examined, sandbox: str) -> Text:
    if node.problem:
        return Text("not used", "red")
    return Text("broken", "red") if node.sandboxes[sandbox] else Text("works", "green")
