"""Attempts to forge an evaluation or a comparison: which are found out, with and without a signature."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.ledger.forgeries import FORGERIES, replace_record, shut_in, worst
from tests.evaluator.ledger.forging import Forgery, Rescored
from tests.evaluator.sample_agents import Command
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_engine.record import read_record, save, verify_record
from wildscav_evaluator.cli.commands.compare import compare
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.cli.sessions.run_again import run_again
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ledger.keys import SigningKey, new_key
from wildscav_evaluator.output.layout import COMPARISON_FILE
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.scores.compare import Comparisons
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.seeds import SuiteSeed


def test_what_was_really_evaluated_is_borne_out(
    signed: Forgery, key: SigningKey, capsys: pytest.CaptureFixture[str]
) -> None:
    run_rescore(signed.out, LocalExecutor(1), key.public)
    said = " ".join(capsys.readouterr().out.split())
    assert "10 records played again: all agree" in said
    assert f"signed with the key {key.public}: nothing was changed or removed since" in said

    run_rescore(signed.out, LocalExecutor(1))
    assert "if that is the organizer's, confirm it with --key" in capsys.readouterr().out


def test_an_unsigned_folder_is_told_to_prove_no_more_than_it_does(
    unsigned: Forgery, capsys: pytest.CaptureFixture[str]
) -> None:
    run_rescore(unsigned.out, LocalExecutor(1))
    assert "not signed: the recorded actions give these scores" in capsys.readouterr().out


@pytest.mark.parametrize("name", FORGERIES)
def test_a_forgery_of_results_and_records_is_found_out_though_nobody_signed(
    unsigned: Forgery, rescored: Rescored, name: str
) -> None:
    forge, line = FORGERIES[name]
    index = worst(unsigned)

    forge(unsigned)

    said = rescored(unsigned)
    assert line.format(worst=index) in said
    assert "results.json is not the file that ledger.jsonl was closed with" in said


@pytest.mark.parametrize("name", FORGERIES)
def test_a_forgery_of_everything_cannot_be_signed(
    signed: Forgery, rescored: Rescored, key: SigningKey, tmp_path: Path, name: str
) -> None:
    """Results, records, evaluation.json and ledger all tell the same, wrong thing."""
    forge, _ = FORGERIES[name]
    forge(signed)
    assert "results.json is not the file that ledger.jsonl was closed with" in rescored(signed, key.public)

    told = signed.results
    signed.identify(
        sandbox=told.sandbox,
        limits=told.limits,
        submissions=tuple(
            one.model_copy(update={"digest": signed.evaluation(one.name).digest})
            for one in signed.identity.submissions
            if any(one.name == evaluation.submission for evaluation in told.evaluations)
        ),
    )

    mine = new_key(tmp_path / "mine.key")
    signed.rewrite_ledger(mine)
    assert f"is signed with the key {mine.public}, not with {key.public}" in rescored(signed, key.public)

    signed.rewrite_ledger()
    assert "ledger.jsonl is not signed, though the key" in rescored(signed, key.public)


@pytest.mark.parametrize(
    "name", ["the worst match dropped", "losses blamed on the platform", "a good match told twice"]
)
def test_a_suite_is_demanded_whole_even_of_a_folder_that_is_forged_throughout(
    unsigned: Forgery, rescored: Rescored, name: str
) -> None:
    forge, line = FORGERIES[name]
    index = worst(unsigned)

    forge(unsigned)
    unsigned.rewrite_ledger()

    assert line.format(worst=index) in rescored(unsigned)


def test_only_the_submission_itself_shows_that_it_acted_so(
    plan: EvaluationPlan, unsigned: Forgery, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ada = plan.submissions[0]
    path = unsigned.out / "records" / f"navigation-{worst(unsigned):03d}-ada.wsr"
    run_again(path, ada, seats=[], logs=tmp_path, sandbox="process")
    assert "seat 0 (ada): all 30 steps as recorded" in capsys.readouterr().out

    replace_record(unsigned)
    unsigned.rewrite_ledger()
    run_rescore(unsigned.out, LocalExecutor(1))  # nobody signed it, and every file tells the same

    with pytest.raises(
        UserError, match=r"seat 0 \(ada\) acts differently than recorded in .* first in step 1:"
    ):
        run_again(path, ada, seats=[], logs=tmp_path, sandbox="process")
    assert "warning" not in capsys.readouterr().out
    other = replace(ada, digest="0" * 32)
    with pytest.raises(UserError, match="acts differently"):
        run_again(path, other, seats=[], logs=tmp_path, sandbox="process")
    assert "warning: these are not the files of ada that were evaluated" in capsys.readouterr().out


def test_results_and_identity_cannot_be_taken_away(signed: Forgery, rescored: Rescored) -> None:
    results = (signed.out / "results.json").read_bytes()
    (signed.out / "results.json").unlink()
    assert "though the ledger says that the evaluation was completed" in rescored(signed)

    (signed.out / "results.json").write_bytes(results)
    (signed.out / "evaluation.json").unlink()
    assert "without it, the entrants are not known" in rescored(signed)


def test_results_that_tell_what_there_is_not_are_one_clear_line(signed: Forgery, rescored: Rescored) -> None:
    ada, bob = signed.results.evaluations

    signed.tell(evaluations=(ada, bob, bob))
    assert "bob has two results on navigation" in rescored(signed)

    signed.tell(evaluations=(ada.model_copy(update={"track": "chess"}), bob))
    assert "there is no track 'chess'" in rescored(signed)

    signed.tell(evaluations=(ada, bob.model_copy(update={"track": "royale"})))
    assert "match 0 is in the results, but the suite has only 0" in rescored(signed)


def test_the_command_ends_with_an_exit_code_and_a_line(
    signed: Forgery, key: SigningKey, wildscav: Command
) -> None:
    shut_in(signed)

    done = wildscav("verify", signed.out, "--key", key.public, "--workers", 1)

    assert done.returncode == 1
    assert "wildscav: results.json says sandbox oci, evaluation.json process" in done.stderr


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


MATCHES = range(5)


def told(out: Path, name: str) -> list[int]:
    """What a submission's agent was told in each match, as it said itself."""
    return [int((out / "logs" / f"navigation-{index:03d}-{name}.log").read_text()) for index in MATCHES]


def test_each_submission_is_told_seeds_of_its_own_and_the_same_ones_again(
    plan: EvaluationPlan, evaluated: Path
) -> None:
    seeds = {name: told(evaluated, name) for name in ("ada", "bob")}
    assert len({*seeds["ada"], *seeds["bob"]}) == 2 * len(MATCHES)

    again = replace(plan, submissions=tuple(load_submission(one.folder) for one in plan.submissions))
    assert seeds == {
        name: [job.seeds[0] for job in again.make_jobs() if job.evaluated == name] for name in seeds
    }


def test_another_secret_gives_other_seeds_even_in_the_same_match(plan: EvaluationPlan) -> None:
    spec, digest = plan.matches("navigation")[0], plan.submissions[0].digest
    assert SuiteSeed(1).private(spec, [digest]) != plan.seed.private(spec, [digest])


def test_a_record_has_what_its_agent_was_told_and_is_verified_without_a_secret(evaluated: Path) -> None:
    for index in MATCHES:
        record = read_record(evaluated / "records" / f"navigation-{index:03d}-ada.wsr")
        assert record.seeds == (told(evaluated, "ada")[index],)
        assert verify_record(record).holds


def test_an_organizer_who_hands_out_other_seeds_is_found_out(unsigned: Forgery, rescored: Rescored) -> None:
    path = unsigned.record("ada", 3)
    save(replace(read_record(path), seeds=(7,)), path)
    unsigned.rewrite_ledger()
    line = "navigation-003-ada.wsr: its agents were not told the private seeds that follow from the seed"
    assert rescored(unsigned).count(line) == 1
