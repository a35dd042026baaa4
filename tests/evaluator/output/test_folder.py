"""An output folder holds one evaluation: which, where it lies if nobody says where, and who may write it."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from time import sleep

import pytest
from tests.evaluator.results_by_hand import RESULTS, evaluation, identity_of, plan_of
from tests.evaluator.sample_agents import WALKER, Submit

from wildscav.errors import UserError
from wildscav_evaluator.output.folder import keep_only, output_folder
from wildscav_evaluator.output.identity import Identity, difference, read_identity, write_identity
from wildscav_evaluator.output.layout import IDENTITY_FILE
from wildscav_evaluator.output.lock import LOCK, locked
from wildscav_evaluator.output.numbered_folders import make_next_folder, own_folder
from wildscav_evaluator.output.results import Results, write_results
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.scores.compare import changes_since_last
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
    without = plan.identity().model_copy(update={"limits": {}})
    assert difference(without, plan.identity()) == "its limits are of other tracks"


def test_a_folder_that_does_not_say_what_it_holds_is_refused(plan: EvaluationPlan) -> None:
    (plan.out / "records").mkdir(parents=True)
    (plan.out / "records" / "mine.wsr").touch()
    assert "holds an evaluation that cannot be identified" in refusal(plan)
    assert [path.name for path in plan.out.iterdir()] == ["records"], "what is refused is left as it is"

    (plan.out / IDENTITY_FILE).write_text("{}")
    with pytest.raises(UserError, match="not of this version"), output_folder(plan.out, plan.identity()):
        pass
    assert (plan.out / "records" / "mine.wsr").exists()


# What `compare`, `tournament`, a suite of one's own and `secret open` leave in a folder.
OF_EARLIER_COMMANDS = (
    *("results.json", "ledger.jsonl", "comparison.json", "tournament.json", "standings.png"),
    *("suite.toml", "secret.txt"),
)


def test_a_fresh_evaluation_takes_the_folder(plan: EvaluationPlan) -> None:
    with output_folder(plan.out, plan.identity()):
        (plan.out / "records" / "navigation-000-walker.wsr").touch()
        for name in (*OF_EARLIER_COMMANDS, "notes.txt"):
            (plan.out / name).touch()
    other = replace(plan, seed=SuiteSeed(7))

    with output_folder(plan.out, other.identity(), fresh=True):
        assert read_identity(plan.out) == other.identity()
        assert list((plan.out / "records").iterdir()) == []
        assert {path.name for path in plan.out.iterdir() if path.is_file()} == {
            *(IDENTITY_FILE, LOCK, "notes.txt")
        }


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


# An evaluation that is killed while a worker of its own still has something to do, until a file appears.
KILLED = """
import multiprocessing, os, sys, time
from pathlib import Path
from wildscav_evaluator.output.lock import locked

def work(lock, ready):
    ready.set()
    while not Path(sys.argv[2]).exists():
        time.sleep(0.01)

if __name__ == "__main__":
    context = multiprocessing.get_context("spawn")
    ready = context.Event()
    with locked(Path(sys.argv[1])) as lock:
        context.Process(target=work, args=(lock, ready)).start()
        ready.wait()
        os.kill(os.getpid(), 9)
"""


def test_a_folder_is_free_once_the_workers_of_a_killed_evaluation_are_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program, folder, done = tmp_path / "killed.py", tmp_path / "out", tmp_path / "done"
    folder.mkdir()
    program.write_text(KILLED)
    subprocess.run([sys.executable, program, folder, done], stderr=subprocess.DEVNULL)
    waits: list[float] = []

    def wait(seconds: float) -> None:
        waits.append(seconds)
        done.touch()  # the worker ends only once somebody waits for it
        sleep(seconds)

    monkeypatch.setattr("wildscav_evaluator.output.lock.time.sleep", wait)
    with locked(folder):
        assert waits
    assert not (folder / LOCK).exists()


def test_whoever_comes_while_an_evaluation_runs_is_told_without_a_wait(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    waits: list[float] = []
    monkeypatch.setattr("wildscav_evaluator.output.lock.time.sleep", waits.append)

    with locked(tmp_path), pytest.raises(UserError, match="another evaluation is writing"), locked(tmp_path):
        pass

    assert not waits

    with locked(tmp_path):
        assert (tmp_path / LOCK).exists()


def test_a_disk_that_is_full_from_the_start_is_told_with_its_folder(tmp_path: Path) -> None:
    (tmp_path / LOCK).symlink_to("/dev/full")
    with pytest.raises(UserError, match=f"{tmp_path / LOCK} cannot be written: "), locked(tmp_path):
        pass


def identity(*names: str, digest: str = "1") -> Identity:
    return identity_of(*names, track="royale", digest=digest)


def begin(parent: Path, one: Identity, *, fresh: bool = False) -> str:
    folder = own_folder(parent, one, fresh=fresh)
    folder.mkdir(parents=True, exist_ok=True)
    write_identity(one, folder)
    return folder.name


def test_each_other_evaluation_gets_the_next_number_and_the_same_one_its_own(tmp_path: Path) -> None:
    parent = tmp_path / "out" / "evaluations"
    first, edited = identity("mine"), identity("mine", digest="2")
    assert begin(parent, first) == "0001-mine"
    assert begin(parent, first) == "0001-mine", "it is continued"
    assert begin(parent, edited) == "0002-mine"
    assert begin(parent, first) == "0001-mine", "an edit undone finds its evaluation again"
    assert begin(parent, first, fresh=True) == "0003-mine"
    assert begin(parent, identity("mine", "homing")) == "0004-mine-homing"
    assert begin(parent, identity("mine", "homing", "hunter")) == "0005-mine-and-2-more"


def test_what_begins_at_once_shares_no_folder(tmp_path: Path) -> None:
    with ThreadPoolExecutor() as threads:
        made = threads.map(lambda _: make_next_folder(tmp_path / "out", ["mine"]), range(20))
    assert sorted(one.name for one in made) == [f"{number:04}-mine" for number in range(1, 21)]


def test_what_else_lies_there_does_no_harm(tmp_path: Path) -> None:
    (tmp_path / "notes").mkdir()
    (tmp_path / "0007-a file").touch()
    (tmp_path / "9999-old").mkdir()
    (tmp_path / "9999-old" / "evaluation.json").write_text('{"format": 0}')
    assert begin(tmp_path, identity("mine")) == "10000-mine"
    assert begin(tmp_path, identity("mine", digest="2")) == "10001-mine"


def kept(parent: Path, number: int, values: tuple[float, ...], *, digest: str, **changed: object) -> Results:
    """An evaluation that was played to its end."""
    one = evaluation("mine", values=values).model_copy(update={"digest": digest})
    results = RESULTS.model_copy(update={"evaluations": (one,), **changed})
    folder = parent / f"{number:04}-mine"
    folder.mkdir(parents=True)
    write_identity(identity("mine", digest=digest), folder)
    write_results(results, folder)
    return results


def test_the_last_evaluation_of_other_files_on_the_same_matches_is_compared_with(tmp_path: Path) -> None:
    kept(tmp_path, 1, (1.0, 1.0), digest="1")
    kept(tmp_path, 2, (2.0, 4.0), digest="2")
    kept(tmp_path, 3, (9.0, 9.0), digest="3", seed=1)
    kept(tmp_path, 4, (9.0, 9.0), digest="4", sandbox="oci")
    (tmp_path / "0005-mine").mkdir()
    write_identity(identity("mine", digest="5"), tmp_path / "0005-mine")  # it was interrupted
    kept(tmp_path, 6, (5.0, 5.0), digest="6")
    now = kept(tmp_path, 7, (5.0, 5.0), digest="6")

    (since,) = changes_since_last(now, tmp_path / "0007-mine")

    assert (since.folder, since.version) == ("0002-mine", "1.0.0")
    assert since.comparison.differences[0].difference == pytest.approx(2.0)
    assert changes_since_last(now, tmp_path / "season") == ()


def test_a_first_evaluation_is_compared_with_nothing(tmp_path: Path) -> None:
    assert changes_since_last(kept(tmp_path, 1, (1.0,), digest="1"), tmp_path / "0001-mine") == ()
