"""What all tests share."""

import gc
import os
import re
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

import wildscav  # noqa: F401 - before any test imports gRPC, which it sets, as it does for its users
from wildscav.terminal.console import console

# The sandboxes have tests of their own; elsewhere agents are our own, and start quicker without.
os.environ.setdefault("WILDSCAV_SANDBOX", "process")
# Programs that tests start say what the tests are about, whether something has to be compiled or not.
os.environ.setdefault("WILDSCAV_QUIET", "1")

# Imports and tests leave objects behind by the million, and next to no garbage.
gc.disable()

# A shell's background jobs ignore Ctrl-C, and whatever they start does, too; some tests press it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# The first call of a kernel may compile it, so no single example has a deadline. The same examples are
# drawn each time, so that a run tells about the code and not about luck; more of them is a run by hand.
settings.register_profile("wildscav", deadline=None, derandomize=True, max_examples=40)
settings.load_profile("wildscav")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Import only the files that can have tests to run: the imports of all take each worker many seconds."""
    if not collection_path.name.startswith("test_"):
        return None
    text = collection_path.read_text("utf-8")
    fixtures = collection_path.with_name("conftest.py")  # their parameters may be slow, too
    shared = fixtures.read_text("utf-8") if fixtures.exists() else ""
    without = {
        "slow": "mark.slow" not in text + shared,
        "not slow": re.search(r"^pytestmark = \[?pytest\.mark\.slow\b", text, re.MULTILINE),
    }
    return bool(without.get(config.option.markexpr)) or None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that take longest, so that no process is left alone with one at the end."""
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


@pytest.fixture(scope="session")
def compiled() -> None:
    """Compile what matches need before anybody's time runs, or before another cache is named."""
    from wildscav_server.hosting.precompile import precompile

    precompile(())


@pytest.fixture(autouse=True)
def stdout_of_commands() -> Iterator[None]:
    """Let commands print to stdout again after one of a test kept it free for JSON."""
    yield
    console.stderr = False


def pytest_collection_finish() -> None:
    """Look for garbage again, but less often than by default."""
    gc.set_threshold(20_000, 20, 20)
    gc.enable()


def pytest_sessionfinish() -> None:
    """Write down what was covered: pytest-xdist kills workers that take more than 10 s to end."""
    coverage = sys.modules.get("coverage")
    current = coverage and coverage.Coverage.current()
    if current:
        current.save()
