"""Comparisons are evaluations, signed and checked as such."""

from pathlib import Path

import pytest
from tests.evaluator.ledger.forging import Forgery, Rescored
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav_evaluator.cli.commands.compare import compare
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ledger.keys import SigningKey
from wildscav_evaluator.output.layout import COMPARISON_FILE
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.scores.compare import Comparisons


@pytest.fixture
def compared(
    plan: EvaluationPlan,
    signed: Forgery,
    key_file: Path,
    warm_workers: WarmWorkers,
    capsys: pytest.CaptureFixture[str],
) -> Forgery:
    """A comparison of what was played already, signed with the same key."""
    ada, bob = (one.folder for one in plan.submissions)
    suite = str(signed.out / "suite.toml")
    capsys.readouterr()
    with playing_with(warm_workers):
        compare(ada, bob, suite=suite, rounds=1, out=signed.out, sandbox="process", sign=key_file)
    said = capsys.readouterr().out
    assert "signed with the key" in said
    assert "its head, to be published with the results:" in said
    return signed


def test_a_comparison_can_be_signed(
    compared: Forgery, key: SigningKey, capsys: pytest.CaptureFixture[str]
) -> None:
    run_rescore(compared.out, LocalExecutor(1), key.public)

    assert "10 records played again: all agree" in capsys.readouterr().out


def test_a_comparison_is_what_its_results_give(
    compared: Forgery, key: SigningKey, rescored: Rescored
) -> None:
    path = compared.out / COMPARISON_FILE
    told = Comparisons.read(path)
    (one,) = told.comparisons
    turned = one.model_copy(update={"pairs": one.pairs + 1})
    told.model_copy(update={"comparisons": (turned,)}).write(path)
    assert "comparison.json is not what results.json gives" in rescored(compared, key.public)

    path.write_text("[" * 100_000)
    assert f"{path} is not a comparison: Invalid JSON" in rescored(compared)
