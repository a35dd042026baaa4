"""The walls between the parts stand."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_the_import_contracts_hold() -> None:
    done = subprocess.run(
        [str(Path(sys.executable).parent / "lint-imports"), "--no-cache"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
    )

    assert done.returncode == 0, done.stdout
    assert "0 broken" in done.stdout


@pytest.mark.parametrize(
    ("module", "stranger"),
    [
        ("wildscav.sdk", "numba"),
        ("wildscav.sdk", "wildscav_engine"),
        ("wildscav.sdk", "pydantic"),
        ("wildscav_evaluator.cli.commands.evaluate", "numba"),
        ("wildscav_leaderboard.cli.leaderboard", "numba"),
        ("wildscav_leaderboard.cli.leaderboard", "sqlalchemy"),
        ("wildscav_leaderboard.hosting.app", "numba"),
        ("wildscav_leaderboard.hosting.app", "scipy"),
        ("wildscav_leaderboard.hosting.app", "grpc"),
        ("wildscav_engine.simulation.match", "numba"),
        ("wildscav_engine.sensors", "numba"),
        ("wildscav_evaluator.cli.sessions.evaluate", "wildscav_leaderboard"),
        ("wildscav_evaluator.cli.sessions.evaluate", "rerun"),
    ],
)
def test_importing_one_does_not_load_the_other(module: str, stranger: str) -> None:
    code = f"import sys, {module}; sys.exit({stranger!r} in sys.modules)"

    assert subprocess.run([sys.executable, "-c", code], timeout=300).returncode == 0


def test_the_platform_folder_does_not_hide_the_standard_library() -> None:
    assert not (ROOT / "platform" / "__init__.py").exists()


def test_the_picture_of_the_folders_is_that_of_the_contracts() -> None:
    script = runpy.run_path(str(ROOT / "docs" / "images" / "rooms.py"))

    assert script["PICTURE"].read_text("utf-8") == script["picture"](), "run python docs/images/rooms.py"
