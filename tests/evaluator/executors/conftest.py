"""The evaluations on this machine with which those on clusters are compared."""

from pathlib import Path

import pytest
from tests.commands import run_command
from tests.evaluator.conftest import submission_in
from tests.evaluator.executors.ray_evaluations import PLODDER, SUITE


@pytest.fixture(scope="session")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A suite of a few short matches."""
    path = tmp_path_factory.mktemp("suite") / "short.toml"
    path.write_text(SUITE)
    return path


@pytest.fixture(scope="session")
def plodder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a submission that takes its time."""
    place = tmp_path_factory.mktemp("submissions")
    return submission_in(place, "plodder", PLODDER, tracks='["navigation", "battle"]').folder


@pytest.fixture(scope="session")
def plodder_here(plodder: Path, suite: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The plodder's evaluation on this machine."""
    out = tmp_path_factory.mktemp("here") / "out"
    options = (f"--suite={suite}", "--sandbox=process", "--replays=none", "--workers=1", f"--out={out}")
    done = run_command("evaluate", plodder, *options)
    assert done.returncode == 0, done.stderr
    return out
