"""Code that one process compiled is found by every other that runs the same sources, wherever they lie."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from wildscav_engine.compilation.caching.levels import CHOICE, LEVELS, levels, processor_of
from wildscav_engine.compilation.caching.sources import PACKAGE
from wildscav_engine.compilation.kernel import PLAIN

pytestmark = pytest.mark.skipif(PLAIN, reason="nothing is compiled")

# Prints where the engine lies, which kernels were compiled, and what they returned: one that calls others,
# and one that takes a named tuple and reads a constant of another file.
USE = """
import json
from numba.core import event

listener = event.RecordingListener()
event.register("numba:compile", listener)

import wildscav_engine
from wildscav_engine.geometry.terrain import Ground, is_steep
from wildscav_engine.arithmetic.elementary_functions import sine

values = [sine(90.0), is_steep(Ground(0.0, 0.0, 1.2, -1.0))]
functions = [one.data["dispatcher"].py_func for _, one in listener.buffer if one.is_start]
compiled = sorted(function.__name__ for function in functions if function.__module__.startswith("wildscav"))
print(json.dumps([wildscav_engine.__file__, compiled, values]))
"""
COMPILED = ["_cosine_of_small", "_sine_of_small", "_sine_of_turn", "is_steep", "sine", "within_turn"]
VALUES = [1.0, True]
HERE = PACKAGE.parent


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The engine as another clone or a wheel has it: in another place, written at another time."""
    place = tmp_path_factory.mktemp("site-packages")
    shutil.copytree(PACKAGE, place / PACKAGE.name, copy_function=shutil.copyfile)
    return place


@pytest.fixture(scope="module")
def kept(elsewhere: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What is kept after the engine elsewhere was used by two processes at once, with nothing kept before."""
    folder = tmp_path_factory.mktemp("cache")
    both = [said_by(process) for process in (start(elsewhere, folder), start(elsewhere, folder))]
    assert sorted(both[0][1] + both[1][1]) == COMPILED  # each by one of them
    assert [values for _, _, values in both] == [VALUES, VALUES]
    return folder


@pytest.fixture
def folder(kept: Path, tmp_path: Path) -> Path:
    """A copy of it, to be spoiled."""
    return Path(shutil.copytree(kept, tmp_path / "cache"))


def start(engine: Path, cache_folder: Path, level: str | None = None) -> "subprocess.Popen[str]":
    """Start a process that uses the engine in a folder, compiling for its processor or for a level."""
    choice = dict(zip(CHOICE, processor_of(level), strict=True)) if level else {}
    environment = {
        **os.environ,
        **choice,
        "PYTHONPATH": str(engine),
        "WILDSCAV_CACHE_DIR": str(cache_folder),
    }
    return subprocess.Popen(
        [sys.executable, "-c", USE], env=environment, stdout=subprocess.PIPE, text=True, cwd=engine
    )


def said_by(process: "subprocess.Popen[str]") -> tuple[Path, list[str], list[Any]]:
    """Return where a process found the engine, what it compiled and what it worked out."""
    said, _ = process.communicate()
    assert process.returncode == 0
    file, compiled, values = json.loads(said)
    return Path(file).parents[1], compiled, values


def test_where_the_engine_lies_is_in_nothing_that_is_kept(kept: Path, elsewhere: Path) -> None:
    files = list(kept.rglob("*.nb*"))
    assert len(files) == 2 * len(COMPILED)
    assert not [file for file in files if bytes(elsewhere) in file.read_bytes()]


def test_after_an_edit_of_a_constant_what_reads_it_is_compiled_anew(folder: Path, tmp_path: Path) -> None:
    edited = tmp_path / "edited"
    shutil.copytree(PACKAGE, edited / PACKAGE.name)
    with (edited / PACKAGE.name / "specs/body.py").open("a") as body:
        body.write("TAN_SLOPE_LIMIT = 2.0\n")
    assert said_by(start(edited, folder)) == (edited, ["is_steep"], [1.0, False])


@pytest.mark.slow
def test_another_copy_of_the_engine_compiles_again_only_what_is_damaged(folder: Path) -> None:
    for file in folder.rglob("*.sine-*.nbc"):
        file.write_bytes(file.read_bytes()[:100])
    for file in folder.rglob("*is_steep-*.nbi"):
        file.write_bytes(b"")
    assert said_by(start(HERE, folder)) == (HERE, ["is_steep", "sine"], VALUES)
    assert said_by(start(HERE, folder)) == (HERE, [], VALUES)


@pytest.mark.parametrize("level", LEVELS)
def test_another_processor_uses_the_same_parts_and_gets_the_same_values(
    level: str, folder: Path, tmp_path: Path
) -> None:
    if level not in levels():
        pytest.skip(f"this processor does not run code for {level}")
    assert said_by(start(HERE, folder, level)) == (HERE, ["is_steep", "sine"], VALUES)
    assert said_by(start(HERE, folder, level)) == (HERE, [], VALUES)


@pytest.fixture
def wheel(folder: Path, tmp_path: Path) -> Path:
    """The engine with machine code of the lowest level, as a wheel brings it, which cannot be written to."""
    lowest = list(LEVELS)[-1]
    if lowest not in levels():
        pytest.skip(f"this processor does not run code for {lowest}")
    said_by(start(HERE, folder, lowest))
    place = tmp_path / "wheel"
    shutil.copytree(PACKAGE, place / PACKAGE.name, copy_function=shutil.copyfile)
    parts = shutil.ignore_patterns("part*")
    shutil.copytree(folder / "kernels", place / PACKAGE.name / "compiled", ignore=parts)
    return place


def test_whoever_installs_a_wheel_compiles_nothing(wheel: Path, tmp_path: Path) -> None:
    assert said_by(start(wheel, tmp_path / "empty")) == (wheel, [], VALUES)
    assert not list(tmp_path.glob("empty/**/*.nbc"))


@pytest.mark.slow
def test_code_that_a_wheel_lacks_is_compiled(wheel: Path, tmp_path: Path) -> None:
    for file in wheel.rglob("*.sine-*.nbc"):
        file.unlink()
    for file in wheel.rglob("*is_steep-*.nbc"):
        file.write_bytes(b"")
    assert said_by(start(wheel, tmp_path / "empty")) == (wheel, COMPILED, VALUES)
    assert said_by(start(wheel, tmp_path / "chosen", list(LEVELS)[-1])) == (wheel, COMPILED, VALUES)
