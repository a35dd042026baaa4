"""The example of an agent in another language plays as the page on submitting says."""

import shutil
import subprocess
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Command
from tests.evaluator.sandbox.available import missing

REPOSITORY = Path(__file__).parents[3]
EXAMPLE = REPOSITORY / "docs" / "examples" / "javascript"
PROTO = REPOSITORY / "platform" / "wildscav" / "proto" / "match.proto"

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("compiled")]


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example with its packages and the protocol; skipped where they cannot be had."""
    for program in ("node", "npm"):
        if shutil.which(program) is None:
            pytest.skip(f"there is no {program}")
    folder = shutil.copytree(EXAMPLE, tmp_path_factory.mktemp("javascript") / "homing-js")
    shutil.copy(PROTO, folder)
    done = subprocess.run(
        ["npm", "install", "--no-audit", "--no-fund"], cwd=folder, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        pytest.skip(f"npm cannot install the packages: {done.stderr.strip().splitlines()[-1]}")
    return folder


@pytest.mark.parametrize("sandbox", ["process", "bubblewrap", "oci"])
def test_it_plays_to_the_end_and_reaches_the_target(
    wildscav: Command, example: Path, sandbox: str, tmp_path: Path
) -> None:
    if sandbox != "process" and missing(sandbox):
        pytest.skip(missing(sandbox))

    done = wildscav("play", example, "--sandbox", sandbox, "--logs", tmp_path / "logs")

    assert done.returncode == 0, done.stderr
    (row,) = (line for line in done.stdout.splitlines() if "homing-js" in line)
    assert "100%" in row
    assert "finished" in row


def test_it_passes_every_check(wildscav: Command, example: Path, tmp_path: Path) -> None:
    done = wildscav("check", example, "--sandbox=process", "--logs", tmp_path / "logs")

    assert "homing-js may be submitted" in done.stdout, done.stdout + done.stderr
