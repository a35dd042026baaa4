"""What an agent is given: its command, its limits, and exactly the files that its digest covers."""

import py_compile
import subprocess
import sys
from pathlib import Path

import pytest
from pydantic import ValidationError
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox.sandbox_runs import run_agent

from wildscav_evaluator.sandbox import Ending, Limits, Sandbox
from wildscav_evaluator.submissions.submission import Submission, folder_digest, load_submission

PROGRAM = """#!/bin/sh
echo "$0 $1 in $PWD, $(cat data.txt), $WILDSCAV_TOKEN, ${WILDSCAV_START_LIMIT}s"
test -S "${WILDSCAV_ADDRESS#unix:}" && echo "a socket"
exit 7
"""


@pytest.fixture
def program(tmp_path: Path) -> Submission:
    """A submission that is a shell script."""
    return written(tmp_path, '["./go", "--fast"]')


def written(folder: Path, command: str) -> Submission:
    code = folder / "code"
    code.mkdir()
    (code / "submission.toml").write_text(
        f'name = "program"\nversion = "1"\ntracks = ["navigation"]\ncommand = {command}\n'
    )
    (code / "go").write_text(PROGRAM)
    (code / "go").chmod(0o755)
    (code / "data.txt").write_text("of its own")
    return load_submission(code)


def run(sandbox: Sandbox, submission: Submission, folder: Path) -> tuple[Ending, str]:
    return run_agent(sandbox, submission, folder, start_limit=30.0)


def test_a_program_is_run_in_its_folder_with_address_and_token(
    sandbox: Sandbox, program: Submission, tmp_path: Path
) -> None:
    ending, log = run(sandbox, program, tmp_path)

    folder = "/submission" if sandbox.isolated else program.folder
    assert log == f"./go --fast in {folder}, of its own, of the seat, 30s\na socket\n"
    assert (ending.exit_code, ending.last_words) == (7, "a socket")


def test_a_program_that_is_not_there_is_the_agents_fault_and_named(sandbox: Sandbox, tmp_path: Path) -> None:
    ending, _ = run(sandbox, written(tmp_path, '["no-such-program"]'), tmp_path)

    assert ending.platform_fault == ""
    assert ending.exit_code not in (0, None)
    assert "no-such-program" in ending.last_words
    if not sandbox.isolated:
        assert ending.last_words == "cannot run no-such-program: No such file or directory"


@pytest.mark.parametrize(
    "wrong",
    [{"cpus": 0}, {"memory": "1 MiB"}, {"processes": 1}, {"wall_clock": -1}, {"memory": "much"}, {"disk": 1}],
)
def test_limits_that_nobody_could_live_under_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        Limits.model_validate(wrong)


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


def test_compiled_code_in_a_cache_never_runs(sandbox: Sandbox, submit: Submit, tmp_path: Path) -> None:
    submission = submit("walker", code=CODE)
    folder = submission.folder
    (folder / "run.sh").touch(0o700)
    (folder / "helper.py").write_text("WORD = 'source'")
    clean = folder_digest(folder)
    compile_something_else(folder)
    (folder / "logs").mkdir()
    control = [sys.executable, "-c", "import helper; print(helper.WORD)"]
    assert subprocess.check_output(control, cwd=folder, text=True) == "changed\n"
    before = entries(folder)

    _, log = run_agent(sandbox, submission, tmp_path)

    assert log == "source ./agent.py ./helper.py ./run.sh ./submission.toml True\n"
    assert folder_digest(folder) == clean
    assert entries(folder) == before
