"""What counts as a failure when `.ci/run` runs the tests, on a small folder of tests."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / ".ci" / "tests"
TESTS = """
import os
from pathlib import Path

import pytest


def fail_once(name):
    if not Path(name).exists():
        Path(name).touch()
        raise RuntimeError("the first time")


@pytest.fixture
def shaky():
    fail_once("of the fixture")


def test_good():
    pass


@pytest.mark.parametrize("value", ["a b", "c::d"])
def test_flaky(value):
    fail_once(value)


def test_of_a_flaky_fixture(shaky):
    pass


def test_bad():
    assert "bad" not in os.environ["HAVE"], os.getpid()


def test_that_crashes():
    if "crash" in os.environ["HAVE"]:
        os._exit(1)
"""


@pytest.mark.parametrize(
    ("have", "code", "closing_lines", "flaky"),
    [
        ("", 0, ["2 failed, 3 passed, 1 error in", "3 passed in"], True),
        ("bad", 1, ["3 failed, 2 passed, 1 error in", "1 failed, 3 passed in"], True),
        ("crash", 1, ["3 failed, 2 passed, 1 error in"], False),  # which no second run makes up for
    ],
)
def test_what_passes_alone_is_flaky_and_what_fails_twice_fails(
    tmp_path: Path, have: str, code: int, closing_lines: list[str], flaky: bool
) -> None:
    (tmp_path / "pytest.ini").write_text("[pytest]\naddopts = -q -p xdist -p timeout")
    (tmp_path / "test_all.py").write_text(TESTS)

    done = subprocess.run(
        [sys.executable, SCRIPT, "-n", "1"],
        capture_output=True,
        cwd=tmp_path,
        env=os.environ | {"HAVE": have, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},  # starts quickly
        text=True,
        timeout=120,
    )

    assert done.returncode == code, done.stdout
    found = [line.rpartition(" ")[0] for line in done.stdout.splitlines() if line[:1].isdigit()]
    assert found == closing_lines
    named = tmp_path / "out" / "flaky-tests"
    expected = ["test_flaky[a b]", "test_flaky[c::d]", "test_of_a_flaky_fixture"] if flaky else []
    assert (named.read_text().splitlines() if named.exists() else []) == [
        f"test_all.py::{name}" for name in expected
    ]


def test_the_shares_of_the_tests_are_all_of_them(tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text(
        "[pytest]\naddopts = -q -p xdist -p timeout --collect-only --import-mode=importlib"
    )
    names = [f"tests/{folder}/test_{number}.py" for folder in "ab" for number in range(3)]
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("def test_it():\n    pass\n")

    found = [
        {line.partition("::")[0] for line in collected(tmp_path, share).splitlines() if "::" in line}
        for share in ("1/4", "2/4", "3/4", "4/4")
    ]

    assert [len(share) for share in found] == [2, 2, 1, 1]
    assert set.union(*found) == set(names)


def collected(folder: Path, share: str) -> str:
    done = subprocess.run(
        [sys.executable, SCRIPT, "tests"],
        capture_output=True,
        check=True,
        cwd=folder,
        env=os.environ | {"SHARE": share, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        text=True,
    )
    return done.stdout


STATIC, VERSIONS = "check docs", "test-oldest test-newest test-openenv"


@pytest.mark.parametrize(
    ("part", "installed", "steps"),
    [
        ([], ".venv/.training", [f"{STATIC} test", "test-slow", VERSIONS]),
        (["static"], ".venv/.dev", [STATIC]),
        (["test"], ".venv/.dev", ["test"]),
        (["slow"], ".venv/.training", ["test-slow"]),
        (["versions"], ".venv/.dev", [VERSIONS]),
    ],
)
def test_a_part_of_the_checks_runs_its_steps_and_fails_with_them(
    part: list[str], installed: str, steps: list[str], tmp_path: Path
) -> None:
    """Programs that install or check anything are replaced by some that write down what they are asked."""
    (tmp_path / "make").write_text(f'#!/bin/sh\necho "$@" >> {tmp_path}/asked\n[ "$1" = {installed} ]\n')
    (tmp_path / "apt-get").write_text("#!/bin/sh\n")
    for name in ("make", "apt-get"):
        (tmp_path / name).chmod(0o755)
    shutil.copytree(ROOT / ".ci", tmp_path / "checkout" / ".ci")

    done = subprocess.run(
        [tmp_path / "checkout" / ".ci" / "run", *part],
        capture_output=True,
        env=os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"},
        text=True,
    )

    first, *others = (tmp_path / "asked").read_text().splitlines()
    assert first == installed
    assert [re.sub(r"^-j\d -k --output-sync=target ", "", line) for line in others] == steps
    assert done.returncode == 1
    assert done.stdout.count("Failed: make") == len(steps)


def test_a_part_that_there_is_not_is_refused() -> None:
    done = subprocess.run([ROOT / ".ci" / "run", "everything"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert "There is no part everything" in done.stderr


@pytest.mark.parametrize(
    ("changed", "kept", "folders", "said"),
    [
        ("", "", (), "Usage: PYTHON .ci/release FOLDER"),
        ("", "", ("dist",), "-m hatchling build -t sdist -d"),  # there is nothing to build
        (
            "agent.py",
            "",
            ("dist",),
            "commit these changes first, or nobody can make the same release:\n?? agent.py",
        ),
        ("", "dist/old.whl", ("dist",), "has files of another release: move them away"),
    ],
)
def test_a_release_is_of_a_commit_and_in_a_folder_of_its_own(
    changed: str, kept: str, folders: tuple[str, ...], said: str, tmp_path: Path
) -> None:
    (tmp_path / ".ci").mkdir()
    (tmp_path / "dist").mkdir()
    shutil.copy(ROOT / ".ci" / "release", tmp_path / ".ci")
    (tmp_path / ".gitignore").write_text("/.ci\n/dist\n")
    for command in (
        ("init", "-q"),
        ("add", "."),
        ("-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "1"),
    ):
        subprocess.run(["git", *command], cwd=tmp_path, check=True)
    for name in filter(None, (changed, kept)):
        (tmp_path / name).touch()

    done = subprocess.run(
        [sys.executable, tmp_path / ".ci" / "release", *folders], capture_output=True, cwd=tmp_path, text=True
    )

    assert done.returncode == 1
    assert said in done.stderr
    assert '.ci/release", line' not in done.stderr, "no traceback"
