"""The walls between the parts stand, besides the import contracts, which `make check` asks for."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("modules", "strangers"),
    [
        ("wildscav.cli.main", {"asyncio", "grpc", "numpy"}),
        (
            "wildscav.sdk.connection, wildscav.geometry",
            {"numba", "pydantic", "rich", "typer"},
        ),
        ("wildscav_engine.simulation.match, wildscav_engine.sensors", {"numba"}),
        ("wildscav_evaluator.cli.commands.evaluate", {"numba"}),
        ("wildscav_evaluator.cli.sessions.evaluate", {"rerun", "wildscav_leaderboard"}),
        ("wildscav_leaderboard.hosting.app", {"grpc", "numba", "scipy"}),
    ],
)
def test_importing_modules_does_not_load_what_only_others_need(modules: str, strangers: set[str]) -> None:
    code = f"import sys, {modules}; sys.exit(' '.join({strangers} & set(sys.modules)) or 0)"

    done = subprocess.run([sys.executable, "-c", code], stderr=subprocess.PIPE, text=True, timeout=300)

    assert (done.returncode, done.stderr) == (0, "")


def test_the_platform_folder_does_not_hide_the_standard_library() -> None:
    assert not (ROOT / "platform" / "__init__.py").exists()


def test_the_picture_of_the_folders_is_that_of_the_contracts() -> None:
    script = runpy.run_path(str(ROOT / "docs" / "images" / "rooms.py"))

    assert script["PICTURE"].read_text("utf-8") == script["picture"](), "run python docs/images/rooms.py"
