"""The reference of the command line: every command with its arguments and options."""

from collections.abc import Iterator
from typing import Any

import typer
from rich.markup import render

from wildscav.cli.main import OTHERS, PANELS, app
from wildscav_website.markdown import code, table

HEAD = """# Every command

This page is generated from the commands themselves and shows what `wildscav COMMAND --help` prints.
[The command line](../command-line.md) describes what all commands have in common.
"""


def page() -> str:
    """Return the page."""
    root: Any = typer.main.get_command(app)
    commands = {name: root.get_command(None, name) for name in root.list_commands(None)}
    lines = [HEAD]
    for panel in [*PANELS, OTHERS]:
        names = [name for name, command in commands.items() if command.rich_help_panel == panel]
        lines += [f"## {panel}\n"] if names else []
        for name in names:
            lines += _entry(f"wildscav {name}", commands[name])
    return "\n".join(lines)


def _entry(path: str, command: Any) -> Iterator[str]:
    """Describe a command and its subcommands.

    Raises:
        ImportError: The command's module cannot be imported.
    """
    if "(Not available:" in (command.help or ""):
        raise ImportError(f"{path} cannot be described: {command.help}")
    context = typer.Context(command, info_name=path)
    yield f"### {path}\n"
    yield f"{_plain(command.help or '')}\n"
    below = getattr(command, "commands", {})
    if below:
        for name, member in below.items():
            yield from _entry(f"{path} {name}", member)
        return
    usage = " ".join([path, *command.collect_usage_pieces(context)])
    yield f"```console\n{usage}\n```\n"
    shown = [(one, one.get_help_record(context)) for one in command.params if not one.hidden]
    for kind, title in (("argument", "argument"), ("option", "option")):
        records = [record for one, record in shown if record and one.param_type_name == kind]
        yield table((title, "what it is"), ((code(name), _plain(text)) for name, text in records))


def _plain(text: str) -> str:
    """Return a help text without the markup of Rich."""
    return render(text.replace("[default", "\\[default").replace("[required", "\\[required")).plain
