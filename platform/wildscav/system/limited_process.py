"""Processing of untrusted files in a separate process with limits on its time and memory.

``call_limited`` runs

    python -m wildscav.system.limited_process module:function < arguments.json

Arguments and results must be JSON values.
"""

import contextlib
import importlib
import json
import operator
import os
import resource
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from wildscav.errors import UserError, describe
from wildscav.system.worker_processes import end_with_parent

MEMORY = 224 << 20  # bytes, beyond what Python uses once the function's module is imported
PROCESSOR_TIME = 6  # s
WALL_TIME = 120.0  # s; on a busy machine a process gets only a part of a core


class LimitExceededError(UserError):
    """A file would take more time or memory to read than it may."""


def call_limited(
    function: str, *arguments: Any, memory: int = MEMORY, processor_time: int = PROCESSOR_TIME
) -> Any:
    """Call a function in a limited process, and return its result.

    Args:
        function: As "module:function" or "module:Class.method".
        memory: Bytes that it may take, beyond what Python uses.
        processor_time: s that it may take, likewise.

    Raises:
        LimitExceededError: It exceeded a limit; the message says which.
        UserError: The function raised this or any other exception.
    """
    limits = str(memory), str(processor_time)
    command = [sys.executable, "-m", "wildscav.system.limited_process", function, *limits]
    try:
        done = subprocess.run(
            command, input=json.dumps(arguments).encode(), capture_output=True, timeout=WALL_TIME, check=False
        )
    except subprocess.TimeoutExpired:
        raise LimitExceededError(f"it takes more than {WALL_TIME:g} s") from None
    try:
        answer = json.loads(done.stdout)
    except ValueError:
        # It was killed before it could answer: by the time limit, or by a system that ran out of memory.
        late = done.returncode == -signal.SIGXCPU
        too_long = f"it takes more than {processor_time} s of processor time"
        raise LimitExceededError(too_long if late else _too_much(memory)) from None
    if "result" in answer:
        return answer["result"]
    error = LimitExceededError if answer["limit"] else UserError
    raise error(answer["error"], exit_code=answer.get("exit_code", 1))


def _too_much(memory: int) -> str:
    return f"it takes more than {memory >> 20} MiB of memory"


def main(function: str, memory: int, processor_time: int) -> None:
    """Call a function with the arguments from stdin, and write its result or error to stdout."""
    end_with_parent(os.getppid())
    module, _, name = function.partition(":")
    called = operator.attrgetter(name)(importlib.import_module(module))
    arguments = json.loads(sys.stdin.buffer.read())
    _limit(memory, processor_time)
    try:
        answer = {"result": called(*arguments)}
    except MemoryError:
        answer = {"error": _too_much(memory), "limit": True}
    except RecursionError:
        answer = {"error": "it is nested too deeply", "limit": True}
    except UserError as error:
        answer = {"error": str(error), "limit": False, "exit_code": error.exit_code}
    except OSError as error:
        answer = {"error": describe(error), "limit": False}
    except Exception as error:  # noqa: BLE001 - libraries raise anything for a damaged file
        answer = {"error": " ".join(f"{type(error).__name__}: {error}".split())[:500], "limit": False}
    sys.stdout.write(json.dumps(answer))
    sys.stdout.flush()
    os._exit(0)  # without cleaning up, which could fail under the limits


def _limit(memory: int, processor_time: int) -> None:
    """Set the limits of this process, on top of the time and memory that it has used so far."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    seconds = int(used.ru_utime + used.ru_stime) + processor_time
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 2))
    with contextlib.suppress(OSError, ValueError):
        pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
        most = pages * resource.getpagesize() + memory
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
