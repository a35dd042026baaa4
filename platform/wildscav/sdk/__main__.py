"""Start an agent: ``python -m wildscav.sdk agent:Homing``, in the submission's folder.

Or ``python -m wildscav.sdk FOLDER``: the folder's submission.toml names the entry point, or a command that
replaces this process. For a server with TLS, the options ``--ca``, ``--cert`` and ``--key`` name files, like
the environment variables ``WILDSCAV_CA`` and so on. Exit codes: 0 the match was played, 2 wrong usage, 3 the
agent's code failed, 4 the server cannot be reached or refuses the seat.
"""

import asyncio
import importlib
import os
import sys
import traceback
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn

from wildscav.errors import RefusedError, ServerUnreachableError, UserError
from wildscav.sdk.credentials import CA_VARIABLE, CERT_VARIABLE, KEY_VARIABLE
from wildscav.sdk.run import run
from wildscav.sdk.submission_folder import MANIFEST, entry_point_of, load_agent_class, read_manifest
from wildscav.sdk.watchdog import watch_start_up

PLAYED, USAGE, AGENT_FAILED, NO_SERVER = 0, 2, 3, 4
PACKAGE = Path(__file__).parents[1]  # the package wildscav
OPTIONS = {"--ca": CA_VARIABLE, "--cert": CERT_VARIABLE, "--key": KEY_VARIABLE}
USAGE_LINE = (
    "usage: python -m wildscav.sdk MODULE:CLASS [--ca FILE] [--cert FILE --key FILE]"
    "  (or FOLDER with a submission.toml instead of MODULE:CLASS)"
)


def main(arguments: list[str]) -> int:
    """Play one match and return the exit code."""
    target = _take_options(arguments)
    if target is None:
        return _fail(USAGE, USAGE_LINE)
    try:
        entry_point = _enter(target)
        watch_start_up()
        run(load_agent_class(entry_point))
    except UserError as error:
        return _fail(error.exit_code, str(error))
    except (ServerUnreachableError, RefusedError) as error:
        return _fail(NO_SERVER, str(error))
    except KeyboardInterrupt:
        return 130
    except (Exception, SystemExit) as error:  # noqa: BLE001 - an agent's code can raise anything
        _print_own_code(error)
        return AGENT_FAILED
    return PLAYED


def _take_options(arguments: list[str]) -> str | None:
    """Put the options into the environment, and return the other argument; None if the usage is wrong."""
    rest = list(arguments)
    while len(rest) > 2 and rest[-2] in OPTIONS:
        value, name = rest.pop(), rest.pop()
        os.environ[OPTIONS[name]] = str(Path(value).absolute())  # the working directory will change
    return rest[0] if len(rest) == 1 and not rest[0].startswith("-") else None


def _fail(code: int, message: str) -> int:
    print(f"wildscav: {message}", file=sys.stderr)  # noqa: T201 - the SDK comes without rich
    return code


def _enter(target: str) -> str:
    """Change to the submission's folder, put it first on the path, and return the entry point.

    If the submission has a command, this process is replaced with it.
    """
    if ":" not in target and Path(target).is_dir():
        manifest = read_manifest(Path(target) / MANIFEST)
        os.chdir(target)
        if "command" in manifest:
            _execute(manifest["command"])
        entry_point = entry_point_of(manifest)
    else:
        entry_point = target
    sys.path.insert(0, str(Path.cwd()))
    return entry_point


def _execute(command: Any) -> NoReturn:
    """Replace this process with a submission's command."""
    if not isinstance(command, list) or not command or not all(isinstance(word, str) for word in command):
        raise UserError("submission.toml: command must be a list of strings", USAGE)
    try:
        os.execvp(command[0], command)  # noqa: S606 - no shell is needed
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise UserError(f"cannot run the command {command[0]!r}: {reason}", USAGE) from None


def _print_own_code(error: BaseException) -> None:
    """Print a traceback without the leading frames of the SDK."""
    trace: TracebackType | None = error.__traceback__
    while trace is not None and _is_outside_agent(trace):
        trace = trace.tb_next
    traceback.print_exception(type(error), error, trace, file=sys.stderr)


def _is_outside_agent(trace: TracebackType) -> bool:
    folders = (str(PACKAGE), *asyncio.__path__, "<frozen importlib")
    return trace.tb_frame.f_code.co_filename.startswith((*folders, importlib.__file__))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
