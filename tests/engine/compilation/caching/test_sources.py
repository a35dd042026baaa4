"""Compiled code is never older than the sources that it came from, wherever they lie."""

import shutil
from pathlib import Path

import pytest

from wildscav_engine.compilation.caching import sources

ENGINE = sources.PACKAGE
ROBOTS = ("walker", "gatherer", "fighter", "seeker", "hunter_squad")
# How a kernel's file, ``game/systems/motion.py``, can come by what is in a file.
IMPORTS = [
    ("", "game/systems/motion.py"),
    ("from game.body import GRAVITY", "game/body.py"),
    ("from game import body", "game/body.py"),
    ("from game import body as shape", "game/body.py"),
    ("import game.body", "game/body.py"),
    ("import game.body", "game/__init__.py"),
    ("import numpy, game.body as shape", "game/body.py"),
    ("from game.body import *", "game/body.py"),
    ("from ..body import GRAVITY", "game/body.py"),
    ("from .. import body", "game/body.py"),
    ("from . import walking", "game/systems/walking.py"),
    ("from game.systems import walking", "game/systems/walking.py"),
    ("from game.systems import SPEED", "game/systems/__init__.py"),
    ("def speed():\n    from game.body import GRAVITY\n    return GRAVITY", "game/body.py"),
    ("class Motion:\n    def speed(self):\n        import game.body", "game/body.py"),
    ("if True:\n    pass\nelse:\n    from game import body", "game/body.py"),
    ("try:\n    pass\nexcept ValueError:\n    from game import body", "game/body.py"),
    ("try:\n    pass\nfinally:\n    from game import body", "game/body.py"),
    ("with open('x'):\n    from game import body", "game/body.py"),
    ("match 1:\n    case 1:\n        from game import body", "game/body.py"),
    ("if TYPE_CHECKING:\n    pass\nelse:\n    from game import body", "game/body.py"),
    ("from game.systems import walking", "game/rules.py"),  # through walking.py
    ("from wildscav_engine import rng", "wildscav_engine/rng.py"),
]
# How it does not come by what is in ``game/view.py``.
OTHERS = [
    "from game import body",
    "import game.body as shape",
    "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from game.view import LIGHT",
    "import typing\nif typing.TYPE_CHECKING:\n    from game.view import LIGHT",
]


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with an engine, and a game built on it."""
    for name in ("wildscav_engine/__init__.py", "wildscav_engine/rng.py", "game/__init__.py", "game/body.py"):
        write(tmp_path / name, "GRAVITY = 9.81\n")
    write(tmp_path / "game/systems/__init__.py", "SPEED = 4.0\n")
    write(tmp_path / "game/systems/walking.py", "from game.rules import WALK\n")
    write(tmp_path / "game/rules.py", "WALK = 1.0\n")
    write(tmp_path / "game/view.py", "LIGHT = 1.0\n")
    monkeypatch.setattr(sources, "PACKAGE", tmp_path / "wildscav_engine")
    return tmp_path


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def digest(file: Path) -> str:
    """Return the digest that a new process would find."""
    for remembered in (sources.sources_digest, sources.content_digest, sources.imported_files):
        remembered.cache_clear()
    return sources.sources_digest(file)


@pytest.mark.parametrize(
    ("imports", "edited", "changes"),
    [*((*case, True) for case in IMPORTS), *((imports, "game/view.py", False) for imports in OTHERS)],
)
def test_an_edit_changes_the_digest_of_all_that_imports_it(
    root: Path, imports: str, edited: str, changes: bool
) -> None:
    motion = root / "game/systems/motion.py"
    write(motion, imports + "\n")
    before = digest(motion)

    with (root / edited).open("a") as file:
        file.write("GRAVITY = 1.62\n")

    assert (digest(motion) != before) == changes


def test_a_file_outside_of_packages_depends_on_those_beside_it(tmp_path: Path) -> None:
    write(tmp_path / "helpers.py", "GRAVITY = 9.81\n")
    write(tmp_path / "script.py", "import numpy\nfrom helpers import GRAVITY\n")
    assert sources.closure(tmp_path / "script.py") == {tmp_path / "script.py", tmp_path / "helpers.py"}


def test_neither_place_nor_time_of_the_sources_is_in_the_digest(root: Path, tmp_path: Path) -> None:
    write(root / "game/systems/motion.py", "from game.body import GRAVITY\n")
    shutil.copytree(root / "game", tmp_path / "site-packages/game", copy_function=shutil.copyfile)
    here, there = (folder / "game/systems/motion.py" for folder in (root, tmp_path / "site-packages"))
    assert digest(here) == digest(there)


@pytest.mark.parametrize("version", ["numba 0", "llvmlite 0", "numpy 0", "cpython-0"])
def test_another_compiler_is_another_digest(
    root: Path, monkeypatch: pytest.MonkeyPatch, version: str
) -> None:
    before = digest(root / "game/body.py")
    assert version.rstrip("0").strip(" ") in sources.compiler_versions()
    monkeypatch.setattr(sources, "compiler_versions", lambda: version)
    assert digest(root / "game/body.py") != before


@pytest.mark.parametrize(
    ("file", "needed"),
    [
        (
            "engine/wildscav_engine/simulation/step.py",
            {
                *("wildscav_engine/simulation/step.py", "wildscav_engine/motion/body_motion.py"),
                *("wildscav_engine/geometry/sweep.py", "wildscav_engine/specs/rules.py"),
                "wildscav_engine/compilation/kernel.py",
                # Robots are found by name.
                *(f"wildscav_engine/simulation/robots/{name}.py" for name in ROBOTS),
            },
        ),
        (
            "platform/wildscav_training/opponents/seat_messages.py",
            {
                *("wildscav_training/opponents/seat_messages.py", "wildscav_engine/simulation/state.py"),
                "wildscav_server/hosting/observation_encoding.py",
            },
        ),
    ],
)
def test_kernels_depend_on_files_that_are_imported_through_others(file: str, needed: set[str]) -> None:
    files = {sources.name_of(path) for path in sources.closure(ENGINE.parents[1] / file)}
    assert needed <= files
    assert "wildscav_engine/view/__init__.py" not in files


def test_imports_are_remembered_until_the_file_changes(
    root: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path / "cache"))
    file = root / "game/systems/motion.py"
    write(file, "from game.body import GRAVITY\n")
    sources._remembered.cache_clear()
    found = digest(file)
    sources._remembered.cache_clear()
    with monkeypatch.context() as patch:
        patch.delattr("ast.parse")
        assert digest(file) == found
    write(file, "from game.view import LIGHT\n")
    assert digest(file) != found
    assert sources.imported_files(file) == (root / "game/view.py",)
    sources._remembered.cache_clear()
