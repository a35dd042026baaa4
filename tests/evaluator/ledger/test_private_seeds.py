"""The private seed that an agent is told: another one for each submission, recorded, and checked."""

from dataclasses import replace
from pathlib import Path

from tests.evaluator.ledger.forging import Forgery, Rescored

from wildscav_engine.record import read_record, save, verify_record
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.seeds import SuiteSeed

MATCHES = range(5)


def told(out: Path, name: str) -> list[int]:
    """What a submission's agent was told in each match, as it said itself."""
    return [int((out / "logs" / f"navigation-{index:03d}-{name}.log").read_text()) for index in MATCHES]


def test_two_submissions_are_told_other_seeds_in_the_same_match(evaluated: Path) -> None:
    assert len({*told(evaluated, "ada"), *told(evaluated, "bob")}) == 2 * len(MATCHES)


def test_the_same_submission_is_told_the_same_seeds_again(plan: EvaluationPlan, evaluated: Path) -> None:
    again = replace(plan, submissions=tuple(load_submission(one.folder) for one in plan.submissions))
    seeds = {
        name: [job.seeds[0] for job in again.make_jobs() if job.evaluated == name] for name in ("ada", "bob")
    }
    assert seeds == {name: told(evaluated, name) for name in ("ada", "bob")}


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
