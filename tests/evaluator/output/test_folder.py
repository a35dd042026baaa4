"""An output folder holds one evaluation: the same one goes on in it, another is refused."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.results_by_hand import plan_of
from tests.evaluator.sample_agents import WALKER, Submit

from wildscav.errors import UserError
from wildscav_evaluator.output.folder import keep_only, output_folder
from wildscav_evaluator.output.identity import read_identity
from wildscav_evaluator.output.layout import IDENTITY_FILE
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import SUITES, Suite


@pytest.fixture
def plan(submit: Submit, tmp_path: Path) -> EvaluationPlan:
    walker = submit("walker", WALKER, tracks='["navigation", "gathering"]')
    return plan_of(walker, out=tmp_path / "out")


def refusal(plan: EvaluationPlan) -> str:
    """The line that a plan is refused with."""
    with pytest.raises(UserError) as refused, output_folder(plan.out, plan.identity()):
        pass
    assert refused.value.exit_code == 2
    assert "--fresh" in str(refused.value)
    return str(refused.value)


def test_what_does_not_change_the_results_may_change_between_sittings(plan: EvaluationPlan) -> None:
    for one in (plan, replace(plan, jobs=2), replace(plan, replays="all")):
        with output_folder(plan.out, one.identity()):
            assert read_identity(plan.out) == plan.identity()


def test_another_evaluation_is_refused_with_the_difference(plan: EvaluationPlan, submit: Submit) -> None:
    with output_folder(plan.out, plan.identity()):
        pass
    walker = plan.submissions[0]
    newer = replace(walker, manifest=walker.manifest.model_copy(update={"version": "1.1.0"}))
    (walker.folder / "agent.py").write_text("import time")
    changed = load_submission(walker.folder)

    for other, says in (
        (replace(plan, suite=SUITES["official"]), "its suite is quick, not official"),
        (replace(plan, seed=SuiteSeed(7)), "its seed is 0, not 7"),
        (replace(plan, sandbox="oci"), "its sandbox is process, not oci"),
        (
            replace(plan, suite=limited(output=4096)),
            "output on navigation is 1,000,000, not 4,096",
        ),
        (replace(plan, tracks=("gathering",)), "its tracks are navigation, not gathering"),
        (replace(plan, submissions=(newer,)), "it is of walker 1.0.0, not 1.1.0"),
        (replace(plan, submissions=(submit("other", WALKER),)), "it is of walker, not of other"),
        (replace(plan, submissions=(changed,)), "the files of walker have changed since"),
    ):
        assert says in refusal(other)
    assert read_identity(plan.out) == plan.identity()


def limited(**limits: object) -> Suite:
    """The quick suite with other limits of agents, as another version of Wildscav may have them."""
    navigation = Limits.model_validate(limits)
    return replace(SUITES["quick"], limits={"navigation": navigation})


def test_limits_are_of_an_evaluation_as_far_as_its_sandbox_keeps_them(plan: EvaluationPlan) -> None:
    less = replace(plan, suite=limited(memory="1GiB"))
    assert less.identity() == plan.identity(), "a plain process may take what it likes"

    plan, less = replace(plan, sandbox="bubblewrap"), replace(less, sandbox="bubblewrap")
    with output_folder(plan.out, plan.identity()):
        pass
    assert "its limit of memory on navigation is 2,147,483,648, not 1,073,741,824" in refusal(less)


def test_a_folder_that_does_not_say_what_it_holds_is_refused(plan: EvaluationPlan) -> None:
    (plan.out / "records").mkdir(parents=True)
    (plan.out / "records" / "mine.wsr").touch()
    assert "holds an evaluation that cannot be identified" in refusal(plan)
    assert [path.name for path in plan.out.iterdir()] == ["records"], "what is refused is left as it is"

    (plan.out / IDENTITY_FILE).write_text("{}")
    with pytest.raises(UserError, match="not of this version"), output_folder(plan.out, plan.identity()):
        pass
    assert (plan.out / "records" / "mine.wsr").exists()


def test_a_fresh_evaluation_takes_the_folder(plan: EvaluationPlan) -> None:
    with output_folder(plan.out, plan.identity()):
        (plan.out / "records" / "navigation-000-walker.wsr").touch()
        (plan.out / "notes.txt").touch()
    other = replace(plan, seed=SuiteSeed(7))

    with output_folder(plan.out, other.identity(), fresh=True):
        assert read_identity(plan.out) == other.identity()
        assert list((plan.out / "records").iterdir()) == []
        assert (plan.out / "notes.txt").exists()


def test_halves_of_files_and_matches_that_do_not_count_are_removed(plan: EvaluationPlan) -> None:
    with output_folder(plan.out, plan.identity()):
        (plan.out / "matches").mkdir()  # by Wildscav 0.1.0
        for name in (
            *("records/a.wsr", "logs/a.log", "matches/a.json", "records/b.wsr", "logs/b.log"),
            *("records/.b.wsr.12.part", "matches/.a.json.12.part", ".results.json.12.part", "results.json"),
        ):
            (plan.out / name).touch()
        keep_only(plan.out, ["a"])

    left = {str(path.relative_to(plan.out)) for path in plan.out.rglob("*") if path.is_file()}
    assert left == {"records/a.wsr", "logs/a.log", "matches/a.json", "results.json", IDENTITY_FILE}
