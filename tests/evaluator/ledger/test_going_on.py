"""An evaluation does not go on over what was changed."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.ledger.forgeries import worst
from tests.evaluator.ledger.forging import Forgery, with_metrics

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.ledger.keys import new_key
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


def test_a_loss_cannot_be_removed_to_be_played_again(plan: EvaluationPlan, signed: Forgery) -> None:
    signed.remove_match("ada", worst(signed))

    with pytest.raises(UserError, match=r"the record of navigation-00.-ada cannot be read: .*: No such file"):
        run_session(replace(plan, out=signed.out))
