"""An agent runs exactly the files that its digest covers, in every sandbox."""

import asyncio
import py_compile
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from tests.evaluator.sandbox.sandbox_runs import LIMITS, listening

from wildscav_evaluator.sandbox import Launch, Sandbox
from wildscav_evaluator.submissions.submission import Submission, folder_digest

CODE = """
import os
import helper
found = [os.path.join(base, name) for base, folders, files in os.walk(".") for name in (*folders, *files)]
print(helper.WORD, *sorted(found), os.access("run.sh", os.X_OK), flush=True)
os._exit(0)
"""
UNCHECKED = py_compile.PycInvalidationMode.UNCHECKED_HASH


def compile_something_else(folder: Path) -> None:
    """Put compiled code into a folder's cache that Python takes for that of its source, unread."""
    helper = folder / "helper.py"
    helper.write_text("WORD = 'changed'")
    py_compile.compile(str(helper), invalidation_mode=UNCHECKED)
    helper.write_text("WORD = 'source'")


def entries(folder: Path) -> dict[Path, tuple[int, int]]:
    return {path: (path.stat().st_mode, path.stat().st_mtime_ns) for path in folder.rglob("*")}


def test_compiled_code_in_a_cache_never_runs(
    sandbox: Sandbox, submit: Callable[..., Submission], tmp_path: Path
) -> None:
    folder = submit("walker", code=CODE).folder
    (folder / "run.sh").touch(0o700)
    (folder / "helper.py").write_text("WORD = 'source'")
    clean = folder_digest(folder)
    compile_something_else(folder)
    (folder / "logs").mkdir()
    control = [sys.executable, "-c", "import helper; print(helper.WORD)"]
    assert subprocess.check_output(control, cwd=folder, text=True) == "changed\n"
    before = entries(folder)

    async def to_end(address: str) -> None:
        launch = Launch(folder, "agent:Player", address, "of the seat", tmp_path / "log", LIMITS)
        agent = await sandbox.start(launch)
        await agent.ended()
        await agent.stop()

    with listening(tmp_path / "match.sock") as address:
        asyncio.run(to_end(address))

    log = (tmp_path / "log").read_text()
    assert log == "source ./agent.py ./helper.py ./run.sh ./submission.toml True\n"
    assert folder_digest(folder) == clean
    assert entries(folder) == before
