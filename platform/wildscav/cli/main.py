"""The ``wildscav`` command. Packages add commands by the entry-point group ``wildscav.commands``.

A command is a function with Typer's annotations, or a Typer application with several subcommands. Its module
is imported only when the command is run or listed in the help. An entry point ``map.look`` is a subcommand of
``map``, whichever package has that.

The website makes its reference of commands from these functions; ``wildscav COMMAND -h`` shows the same.
"""

import functools
import inspect
import os
import sys
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from traceback import walk_tb
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from wildscav.cli.old_names import with_new_names
from wildscav.errors import UserError, WildscavError, describe
from wildscav.terminal.suggestions import did_you_mean
from wildscav.version import __version__

NAME = "wildscav"
GROUP = "wildscav.commands"
# The panels of the help, each in the order of its commands: first what a newcomer needs.
PANELS = {
    "Agents": ("init", "play", "human", "mcp", "check", "build", "train", "dataset"),
    "Evaluations": ("evaluate", "baselines", "compare", "price", "tournament", "leaderboard", "verify"),
    "Matches": ("watch", "replay"),
    "Seasons": ("login", "submit", "team", "season"),
    "Machines and maps": ("serve", "doctor", "map"),
}
OTHERS = "Others"
HIDDEN = {"legacy"}  # works for one more release
HELP_ORDER = tuple(name for names in PANELS.values() for name in names)
UNIX_MODULES = ("fcntl", "resource")  # of Python, but not on Windows
# The extra that all commands of a package need.
PACKAGE_EXTRAS = {
    "wildscav_leaderboard": "leaderboard",
    "wildscav_evaluator": "evaluator",
    "wildscav_legacy": "legacy",
    "wildscav_language": "language",
    "wildscav_stage": "stage",
    "wildscav_server": "server",
}
# The extra that installs a missing module, for commands of any other package.
EXTRAS = {
    "alembic": "leaderboard",
    "cryptography": "evaluator",
    "fastapi": "leaderboard",
    "grpc_health": "server",
    "h5py": "data",
    "httpx": "leaderboard",
    "jinja2": "leaderboard",
    "mcp": "language",
    "minari": "data",
    "numba": "engine",
    "prometheus_client": "server",
    "PIL": "maps",
    "av": "video",
    "pwdlib": "leaderboard",
    "pydantic": "engine",
    "rerun": "view",
    "rfc8785": "evaluator",
    "scipy": "maps",
    "sqlalchemy": "leaderboard",
    "standardwebhooks": "leaderboard",
    "starlette": "stage",
    "structlog": "server",
    "tensorboardX": "training",
    "tomli_w": "leaderboard",
    "torch": "training",
    "trimesh": "maps",
    "uvicorn": "stage",
    "websockets": "stage",
}


class Commands(TyperGroup):
    """The commands of ``wildscav``, or of one of its groups. Those of entry points are imported on demand."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names, in the order of help."""
        names = {*super().list_commands(ctx), *self._points()} - HIDDEN
        known, last = HELP_ORDER, len(HELP_ORDER)
        return sorted(names, key=lambda name: (known.index(name) if name in known else last, name))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command that the arguments begin with; for an unknown name, suggest a similar one."""
        if ctx.parent is None and not ctx.resilient_parsing:
            args = with_new_names(args, self, ctx)
        names = [*self.list_commands(ctx), *HIDDEN]
        if args[0] not in names and not args[0].startswith("-") and not ctx.resilient_parsing:
            ctx.fail(f"No such command {args[0]!r}{did_you_mean(args[0], names)}")
        return super().resolve_command(ctx, args)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command, or None if there is none with that name."""
        point = self._points().get(cmd_name)
        if point is None:
            return super().get_command(ctx, cmd_name)
        try:
            return _command(cmd_name, point.load())
        except Exception as error:  # noqa: BLE001 - a broken plug-in must not break other commands
            return _command(cmd_name, _unavailable(cmd_name, error), options=False)

    def _points(self) -> dict[str, EntryPoint]:
        """Return the entry points of this group by the last part of their names."""
        group = "" if self.name == NAME else f"{self.name}."
        names = {name: point for name, point in _registered().items() if name.startswith(group)}
        return {name: point for long, point in names.items() if "." not in (name := long.removeprefix(group))}


@functools.cache
def _registered() -> dict[str, EntryPoint]:
    """Return all commands by name. To find them, the metadata of every installed package is read."""
    return {point.name: point for point in entry_points(group=GROUP)}


def _command(name: str, function: Callable[..., None] | typer.Typer, *, options: bool = True) -> Any:
    command = _build(name, function, options=options)
    command.name = name
    _unwrap_help(command)
    command.rich_help_panel = next((panel for panel, names in PANELS.items() if name in names), OTHERS)
    return command


def _unwrap_help(command: Any) -> None:
    """Let the help of a command, and of those below it, be wrapped by the terminal's width alone.

    Its docstring is wrapped for the width of the source; these line breaks would be printed, too.
    """
    if command.help:
        paragraphs = inspect.cleandoc(command.help).split("\n\n")
        command.help = "\n\n".join(paragraph.replace("\n", " ") for paragraph in paragraphs)
    for below in getattr(command, "commands", {}).values():
        _unwrap_help(below)


def _build(name: str, function: Callable[..., None] | typer.Typer, *, options: bool) -> Any:
    if isinstance(function, typer.Typer):
        return typer.main.get_command(function)
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode="rich")
    settings = {} if options else {"allow_extra_args": True, "ignore_unknown_options": True}
    app.command(name, context_settings=settings)(function)
    command = typer.main.get_command(app)
    if not isinstance(command, TyperCommand):
        raise TypeError(f"{name} is no single command")
    return command


def _unavailable(name: str, error: Exception) -> Callable[[], None]:
    """Return a replacement for a command that cannot be imported: it explains why."""
    from rich.markup import escape

    why = _remedy(error) or (str(error) if _is_extension_error(error) else f"{type(error).__name__}: {error}")

    def explain() -> None:
        raise UserError(f"{name} is not available: {why}", exit_code=1)

    explain.__doc__ = escape(f"(Not available: {why})")
    return explain


def _remedy(error: BaseException) -> str | None:
    """Return what to install if an error comes from an extra that is not installed."""
    if not isinstance(error, ModuleNotFoundError):
        return None
    missing = (error.name or "").partition(".")[0]
    if missing in UNIX_MODULES:
        return f"it needs Linux, or another Unix: Python has no module {missing} on this system"
    if missing not in EXTRAS:
        return None
    running = {
        frame.f_globals.get("__name__", "").partition(".")[0] for frame, _ in walk_tb(error.__traceback__)
    }
    extra = next((extra for package, extra in PACKAGE_EXTRAS.items() if package in running), EXTRAS[missing])
    return f"it needs the module {missing}; install it with: pip install 'wildscav[{extra}]'"


app = typer.Typer(
    cls=Commands,
    name=NAME,
    help="An open arena for game-playing agents: try an agent, evaluate it, watch it play.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},  # inherited by all commands
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"wildscav {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """An open arena for game-playing agents: try an agent, evaluate it, watch it play."""


def main() -> None:
    """Run ``wildscav``."""
    run(app, NAME)


def run(commands: typer.Typer, name: str) -> None:
    """Run a command line. Errors that users can cause are printed as one line on stderr."""
    try:
        commands(prog_name=name)
    except UserError as error:
        _fail(str(error), error.exit_code)
    except WildscavError as error:
        _fail(str(error), 1)
    except BrokenPipeError:
        # The reader of our output has gone. Without this, the interpreter would report that again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        _fail(describe(error), 1)
    except ModuleNotFoundError as error:
        remedy = _remedy(error)
        if remedy is None:
            raise
        _fail(f"this command is not available: {remedy}", 1)
    except Exception as error:
        if not _is_extension_error(error):
            raise
        _fail(f"{error}; `wildscav doctor` lists what is installed", 1)


def _is_extension_error(error: Exception) -> bool:
    """Return whether an error comes from a package that adds something (its module is imported then)."""
    extensions = sys.modules.get("wildscav_engine.extensions")
    return extensions is not None and isinstance(error, extensions.ExtensionError)


def _fail(message: str, exit_code: int) -> None:
    from wildscav.terminal.console import printable

    typer.echo(f"wildscav: {printable(' '.join(message.split()))}", err=True)
    sys.exit(exit_code)


if __name__ == "__main__":
    main()
