"""Which sandbox is taken, and what is said about it. The sandboxes here are as others would write one."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Command
from tests.evaluator.small_matches import need

from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES, Launch, Promise, RunningAgent, SandboxError
from wildscav_evaluator.sandbox.choose import choose
from wildscav_evaluator.sandbox.process import WARNING

PROCESS = SANDBOXES["process"]


class OneThat:
    """A sandbox that keeps or breaks its one promise."""

    isolated = True

    def __init__(self, name: str, *, keeps: bool) -> None:
        self.name, self._keeps, self.tried = name, keeps, 0
        self.runs_images = name == "oci"

    def promises(self, limits: object) -> tuple[Promise, ...]:
        self.tried += 1
        return (Promise("limit on memory", self._keeps, "64 of 32 MiB", "buy some"),)

    async def start(self, launch: Launch) -> RunningAgent:
        raise NotImplementedError


@pytest.fixture(autouse=True)
def _nothing_remembered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path))


@pytest.mark.parametrize(
    ("oci", "bubblewrap", "taken", "said"),
    [
        (True, True, "oci", []),
        (False, True, "bubblewrap", []),
        (
            False,
            False,
            "process",
            [
                WARNING,
                "oci does not work here: limit on memory: 64 of 32 MiB (buy some)",
                "bubblewrap does not work here: limit on memory: 64 of 32 MiB (buy some)",
            ],
        ),
    ],
)
def test_the_strongest_that_works_is_taken(
    oci: bool, bubblewrap: bool, taken: str, said: Sequence[str]
) -> None:
    sandboxes = [OneThat("oci", keeps=oci), OneThat("bubblewrap", keeps=bubblewrap), PROCESS]

    choice = choose(None, sandboxes, DEFAULT_LIMITS)

    assert choice.sandbox.name == taken
    assert list(choice.warnings) == said


def test_one_that_is_asked_for_and_breaks_a_promise_is_refused() -> None:
    sandboxes = [OneThat("oci", keeps=True), OneThat("bubblewrap", keeps=False), PROCESS]

    with pytest.raises(
        SandboxError, match=r"the sandbox bubblewrap cannot be kept here: limit on memory: 64"
    ):
        choose("bubblewrap", sandboxes, DEFAULT_LIMITS)


def test_sandboxes_that_build_on_linux_are_not_tried_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", "darwin")
    sandboxes = [OneThat("oci", keeps=True), OneThat("bubblewrap", keeps=True), PROCESS]

    choice = choose(None, sandboxes, DEFAULT_LIMITS)

    assert choice.sandbox.name == "process"
    assert choice.warnings[1] == "oci does not work here: it needs Linux, and this system is darwin"
    with pytest.raises(SandboxError, match="bubblewrap cannot be kept here: it needs Linux"):
        choose("bubblewrap", sandboxes, DEFAULT_LIMITS)


def test_a_plain_process_comes_with_a_warning_always() -> None:
    assert choose("process", [PROCESS], DEFAULT_LIMITS).warnings == (WARNING,)


def test_an_image_is_for_containers_alone() -> None:
    sandboxes = [OneThat("oci", keeps=False), OneThat("bubblewrap", keeps=True), PROCESS]

    with pytest.raises(SandboxError, match="an image, which only containers run: oci does not work here"):
        choose(None, sandboxes, DEFAULT_LIMITS, images=True)


def test_what_was_kept_is_not_tried_again_and_what_was_broken_is() -> None:
    good, bad = OneThat("good", keeps=True), OneThat("bad", keeps=False)

    for _ in range(3):
        choose(None, [bad, good, PROCESS], DEFAULT_LIMITS)

    assert (good.tried, bad.tried) == (1, 3)


@pytest.mark.slow
def test_the_doctor_tries_every_promise(wildscav: Command) -> None:
    need("bubblewrap")

    done = wildscav("doctor")

    assert done.returncode == 0, done.stderr
    assert "bubblewrap: 15 of 15 promises kept" in done.stdout
    assert "By default, agents run in" in done.stdout


def test_without_programs_the_doctor_says_what_to_install(
    wildscav: Command,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))

    done = wildscav("doctor")

    assert done.returncode == 1
    assert "install" in done.stdout
    assert "package bubblewrap" in " ".join(done.stdout.split())
    assert "no sandbox keeps all its promises here" in done.stderr
