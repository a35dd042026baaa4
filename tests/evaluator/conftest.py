"""Submissions written for a test, and the command line as its user runs it."""

import contextlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.evaluator.docker_daemon import docker_daemon
from tests.evaluator.results_by_hand import plan_of
from tests.evaluator.sample_agents import CRASHER, WALKER, Command, Submit
from tests.evaluator.small_matches import tiny_suite
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.ledger.keys import SigningKey, new_key
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.submissions.submission import Submission, load_submission
from wildscav_evaluator.suites.suite_file import read_suite

HEAD = """
import os, signal, subprocess, sys, time
from wildscav import Action, Agent

class Player(Agent):
"""

MANIFEST = """
name = "{name}"
version = "1.0.0"
entry_point = "agent:Player"
tracks = {tracks}
"""


@pytest.fixture(scope="session")
def warm_workers() -> Iterator[WarmWorkers]:
    """One worker that has compiled everything."""
    workers = WarmWorkers()
    with workers:
        workers.precompile()
        yield workers


@pytest.fixture(scope="session")
def docker() -> Iterator[str]:
    """The address of a Docker daemon; skipped where none can be had."""
    with contextlib.ExitStack() as stack:
        try:
            address = stack.enter_context(docker_daemon())
        except RuntimeError as error:
            pytest.skip(str(error))
        yield address


def submission_in(
    place: Path,
    name: str,
    body: str = "",
    *,
    code: str | None = None,
    tracks: str = '["navigation"]',
    more: str = "",
) -> Submission:
    """Write a submission whose agent has the given body of a class, or whose file has the given code."""
    folder = place / name
    folder.mkdir(parents=True)
    (folder / "submission.toml").write_text(MANIFEST.format(name=name, tracks=tracks) + more)
    (folder / "agent.py").write_text(HEAD + body if code is None else code)
    return load_submission(folder)


@pytest.fixture
def submit(tmp_path: Path) -> Submit:
    """Write a submission, with arguments of ``submission_in``."""
    return partial(submission_in, tmp_path / "submissions")


@pytest.fixture
def pair(submit: Submit) -> tuple[Path, Path]:
    """The folders of two submissions: one that plays to the end, and one that crashes in every match."""
    return submit("walker", WALKER).folder, submit("crasher", CRASHER).folder


@pytest.fixture
def wildscav() -> Command:
    """Run the `wildscav` command."""
    return run_command


@pytest.fixture(scope="session")
def key_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("organizer") / "season.key"


@pytest.fixture(scope="session")
def key(key_file: Path) -> SigningKey:
    return new_key(key_file)


@pytest.fixture(scope="session")
def plan(tmp_path_factory: pytest.TempPathFactory, key: SigningKey) -> EvaluationPlan:
    """The plan of a signed evaluation: two submissions, which print their seeds, on five short matches."""
    folder, seed = tmp_path_factory.mktemp("season"), "    def reset(self, match): print(match.seed)\n"
    ada = submission_in(folder, "ada", seed + WALKER)
    bob = submission_in(folder, "bob", seed + WALKER.replace("observation.step * 10.0", "90.0"))
    return plan_of(ada, bob, out=folder / "out", suite=read_suite(tiny_suite(folder)), key=key)


@pytest.fixture(scope="session")
def evaluated(plan: EvaluationPlan, warm_workers: WarmWorkers) -> Path:
    """The folder of that evaluation, really played: tests that change it work on copies."""
    with playing_with(warm_workers):
        run_session(plan)
    return plan.out
