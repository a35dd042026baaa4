"""An evaluation does not go on over what was changed."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.executors.match_files import contents
from tests.evaluator.ledger.forgeries import worst
from tests.evaluator.ledger.forging import Forgery, with_metrics
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.ledger.keys import new_key
from wildscav_evaluator.ledger.ledger import parse_ledger
from wildscav_evaluator.output.layout import LEDGER_FILE
from wildscav_evaluator.plans.evaluation import EvaluationPlan


def test_an_edited_ledger_does_not_get_into_the_results(plan: EvaluationPlan, unsigned: Forgery) -> None:
    unsigned_plan = replace(plan, key=None, out=unsigned.out)
    better = with_metrics(
        unsigned.evaluation("ada").matches[0],
        {"time": 0.1, "used_time": 0.1, "punish_time": 0.0, "success": 1.0},
    )
    unsigned.change_matches("ada", lambda row: better if row.index == 0 else row)
    unsigned.rewrite_ledger()

    with pytest.raises(UserError) as refused:
        run_session(unsigned_plan)

    assert refused.value.exit_code == 2
    assert "the metrics of navigation-000-ada in the ledger are not those of its record" in str(refused.value)


def test_a_signed_evaluation_goes_on_only_with_its_key(
    plan: EvaluationPlan, signed: Forgery, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=r"it is signed with the key .*, not unsigned"):
        run_session(replace(plan, key=None, out=signed.out))
    other = new_key(tmp_path / "other.key")
    with pytest.raises(UserError, match=f"not signed with the key {other.public}"):
        run_session(replace(plan, key=other, out=signed.out))

    before = (signed.out / LEDGER_FILE).read_bytes()
    run_session(replace(plan, out=signed.out))
    assert (signed.out / LEDGER_FILE).read_bytes() == before, "nothing happened that was to be entered"


def test_records_without_a_ledger_are_refused_every_time_and_stay(
    plan: EvaluationPlan, unsigned: Forgery
) -> None:
    (unsigned.out / LEDGER_FILE).unlink()
    before = contents(unsigned.out)

    for _ in range(2):
        with pytest.raises(UserError, match=f"has matches that were played, but no {LEDGER_FILE}"):
            run_session(replace(plan, key=None, out=unsigned.out))

    assert contents(unsigned.out) == before


@pytest.mark.slow
def test_replays_can_be_asked_for_later_and_no_match_is_played_again(
    plan: EvaluationPlan, signed: Forgery, warm_workers: WarmWorkers
) -> None:
    before = contents(signed.out)

    with playing_with(warm_workers):
        run_session(replace(plan, out=signed.out, replays="all"))

    after = contents(signed.out)
    assert {path: after[path] for path in before if path.startswith("records/")} == {
        path: content for path, content in before.items() if path.startswith("records/")
    }
    assert sorted(path for path in after if path.startswith("replays/")) == sorted(
        f"replays/navigation-00{index}-{name}.rrd" for index in range(5) for name in ("ada", "bob")
    )
    kinds = [entry.fact.kind for entry in parse_ledger(signed.out, after[LEDGER_FILE]).entries]
    assert [kinds.count(kind) for kind in ("begun", "ended", "resumed")] == [10, 10, 1]


def test_a_loss_cannot_be_removed_to_be_played_again(plan: EvaluationPlan, signed: Forgery) -> None:
    signed.remove_match("ada", worst(signed))

    with pytest.raises(UserError, match=r"the record of navigation-00.-ada cannot be read: .*: No such file"):
        run_session(replace(plan, out=signed.out))
