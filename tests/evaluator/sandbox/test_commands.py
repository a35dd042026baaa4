"""An agent may be any program: its command is run in place of Python, with the same variables and limits."""

import asyncio
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.sandbox.sandbox_runs import LIMITS, listening

from wildscav_evaluator.matches.play import launch_for
from wildscav_evaluator.sandbox import SANDBOXES, Ending, Sandbox
from wildscav_evaluator.submissions.submission import Submission, load_submission

Submit = Callable[..., Submission]
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
    async def to_end(address: str) -> Ending:
        launch = replace(
            launch_for(submission, address, "of the seat", folder / "log", LIMITS), start_limit=30.0
        )
        agent = await sandbox.start(launch)
        try:
            return await agent.ended()
        finally:
            await agent.stop()

    with listening(folder / "match.sock") as address:
        ending = asyncio.run(to_end(address))
    return ending, (folder / "log").read_text()


def test_a_program_is_run_in_its_folder_with_address_and_token(
    real: Sandbox, program: Submission, tmp_path: Path
) -> None:
    ending, log = run(real, program, tmp_path)

    assert log == "./go --fast in /submission, of its own, of the seat, 30s\na socket\n"
    assert (ending.exit_code, ending.last_words) == (7, "a socket")


def test_a_plain_process_runs_it_too(program: Submission, tmp_path: Path) -> None:
    ending, log = run(SANDBOXES["process"], program, tmp_path)

    assert log == f"./go --fast in {program.folder}, of its own, of the seat, 30s\na socket\n"
    assert ending.exit_code == 7


def test_a_program_that_is_not_there_is_the_agents_fault_and_named(real: Sandbox, tmp_path: Path) -> None:
    ending, _ = run(real, written(tmp_path, '["no-such-program"]'), tmp_path)

    assert ending.platform_fault == ""
    assert ending.exit_code not in (0, None)
    assert "no-such-program" in ending.last_words


def test_a_plain_process_names_a_program_that_is_not_there(tmp_path: Path) -> None:
    ending, _ = run(SANDBOXES["process"], written(tmp_path, '["no-such-program"]'), tmp_path)

    assert "cannot run no-such-program: No such file or directory" in str(ending)
