"""One evaluation of two submissions, really played and signed, and copies of its folder to be forged."""

from pathlib import Path

import pytest
from tests.evaluator.ledger.forging import Forgery, Rescored, copied
from tests.evaluator.results_by_hand import plan_of
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ledger.keys import SigningKey, new_key
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.suite_file import read_suite

SUITE = """
name = "tiny"
map = { size = 40, houses = 0 }
[tracks.navigation]
maps = 5
match = { time_limit = 3.0 }
"""
AGENT = """
from wildscav import Action, Agent

class Player(Agent):
    def reset(self, match):
        print(match.seed)

    def act(self, observation):
        return Action(walk_direction={direction}, walk_speed=6.0)
"""
MANIFEST = """
name = "{name}"
version = "1.0.0"
entry_point = "agent:Player"
tracks = ["navigation"]
"""


@pytest.fixture(scope="session")
def key_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("organizer") / "season.key"


@pytest.fixture(scope="session")
def key(key_file: Path) -> SigningKey:
    return new_key(key_file)


@pytest.fixture(scope="session")
def plan(tmp_path_factory: pytest.TempPathFactory, key: SigningKey) -> EvaluationPlan:
    """Two submissions on five short matches."""
    folder = tmp_path_factory.mktemp("season")
    for name, direction in (("ada", "observation.step * 9.0"), ("bob", "90.0")):
        (folder / name).mkdir()
        (folder / name / "agent.py").write_text(AGENT.format(direction=direction))
        (folder / name / "submission.toml").write_text(MANIFEST.format(name=name))
    (folder / "tiny.toml").write_text(SUITE)
    return plan_of(
        *(load_submission(folder / name) for name in ("ada", "bob")),
        out=folder / "out",
        suite=read_suite(folder / "tiny.toml"),
        key=key,
    )


@pytest.fixture(scope="session")
def evaluated(plan: EvaluationPlan, warm_workers: WarmWorkers) -> Path:
    with playing_with(warm_workers):
        run_session(plan)
    return plan.out


@pytest.fixture
def signed(evaluated: Path, tmp_path: Path) -> Forgery:
    """A copy of the folder."""
    return copied(evaluated, tmp_path / "out")


@pytest.fixture
def unsigned(signed: Forgery) -> Forgery:
    """The same folder as nobody signed it."""
    signed.rewrite_ledger()
    return signed


@pytest.fixture
def rescored(capsys: pytest.CaptureFixture[str]) -> Rescored:
    """Rescore a folder that must be refused, and return all the lines that say why."""

    def run(forgery: Forgery, key: str | None = None) -> str:
        capsys.readouterr()
        with pytest.raises(UserError) as refused:
            run_rescore(forgery.out, LocalExecutor(1), key)
        assert refused.value.exit_code != 0
        return f"{capsys.readouterr().err}\n{refused.value}"

    return run
