"""What other packages add to Wildscav, and whether it can be used."""

from collections.abc import Iterator

from rich.table import Table
from rich.text import Text

from wildscav.cli.main import GROUP as COMMANDS
from wildscav.cli.verify import CHECKS
from wildscav_engine.extensions import BUILT_IN, PREFIX, Addition, Registry, loaded, other_groups
from wildscav_evaluator.cli.result_tables.ranking import plain_table
from wildscav_evaluator.executors import EXECUTORS
from wildscav_evaluator.result_sinks import GROUP as SINKS
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.suites.suite import SUITES


def installed() -> Iterator[Addition]:
    """Yield what other packages add, each tried by importing it."""
    registries: list[Registry[object]] = [*map(Registry, BUILT_IN), SANDBOXES, SUITES, EXECUTORS]  # type: ignore[list-item]
    plain = (COMMANDS, CHECKS, SINKS)
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
        mark = Text("broken", "red") if one.problem else Text("works", "green")
        table.add_row(one.group.removeprefix(PREFIX), one.name, str(one.origin), mark, Text(one.problem))
    return table
