"""Tests mirror the packages, and each helper has one name."""

import ast
import functools
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TESTS = ROOT / "tests"
PACKAGES = {
    "engine": ROOT / "engine" / "wildscav_engine",
    "platform/wildscav": ROOT / "platform" / "wildscav",
    "platform/inspect": ROOT / "platform" / "wildscav_inspect",
    "platform/language": ROOT / "platform" / "wildscav_language",
    "platform/legacy": ROOT / "platform" / "wildscav_legacy",
    "platform/server": ROOT / "platform" / "wildscav_server",
    "platform/stage": ROOT / "platform" / "wildscav_stage",
    "platform/training": ROOT / "platform" / "wildscav_training",
    "evaluator": ROOT / "evaluator" / "wildscav_evaluator",
    "leaderboard": ROOT / "leaderboard" / "wildscav_leaderboard",
}
# What no folder of a package can hold: pins that many parts of the engine have in common.
OF_THE_WHOLE_ENGINE = "versions"
FILES = sorted(TESTS.rglob("*.py"))


@functools.cache
def imported(file: Path) -> tuple[str, ...]:
    """Return the full names of all that a file imports."""
    return tuple(_imported(file))


def _imported(file: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = file.relative_to(ROOT).with_suffix("").parts[: -node.level] if node.level else ()
            module = ".".join((*above, *filter(None, [node.module])))
            yield from (f"{module}.{name.name}" for name in node.names)


@pytest.mark.parametrize("part", PACKAGES)
def test_a_folder_with_tests_is_a_folder_of_the_package(part: str) -> None:
    folders = {file.parent.relative_to(TESTS / part) for file in (TESTS / part).rglob("test_*.py")}
    strange = {
        str(folder)
        for folder in folders
        if not (PACKAGES[part] / folder).is_dir() and str(folder) != OF_THE_WHOLE_ENGINE
    }

    assert folders
    assert not strange, "the package has no folder of this name"


def test_no_test_imports_another() -> None:
    found = {
        f"{file.relative_to(ROOT)} imports {name}"
        for file in FILES
        for name in imported(file)
        if any(part.startswith("test_") for part in name.split(".")[:-1]) or name.startswith("test_")
    }
    assert not found


def test_no_file_of_tests_has_two_names() -> None:
    """A helper that is imported as ``builders`` and as ``tests.builders`` is loaded twice."""
    own = {path.stem for path in TESTS.iterdir()} - {
        "platform",
        "website",
    }
    found = {
        f"{file.relative_to(ROOT)} imports {name} without tests."
        for file in FILES
        for name in imported(file)
        if name.split(".")[0] in own
    }
    assert not found
