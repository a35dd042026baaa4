"""What somebody who can write to an evaluation's folder may try, and the line that each attempt is found by.

All are tried on copies of one folder that was really evaluated and signed.
"""

import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.ledger.forging import Forgery, blamed_on_platform, copied, with_metrics

from wildscav.cli.verify import verify
from wildscav.errors import UserError
from wildscav_evaluator.cli.replay_agent_session import run_again
from wildscav_evaluator.cli.rescore_session import run_rescore
from wildscav_evaluator.cli.session import run_session
from wildscav_evaluator.evaluation import Plan
from wildscav_evaluator.ledger.entries import Closed
from wildscav_evaluator.ledger.keys import SigningKey, new_key
from wildscav_evaluator.ledger.ledger import LEDGER_FILE, read_ledger
from wildscav_evaluator.output.results import KeptLimits, MatchRow
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.own_suite import read_suite
from wildscav_evaluator.suites.seeds import SuiteSeed

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
    def act(self, observation):
        return Action(walk_direction={direction}, walk_speed=6.0)
"""
MANIFEST = """
name = "{name}"
version = "1.0.0"
entry_point = "agent:Player"
tracks = ["navigation"]
"""
MATCHES = 5
Rescored = Callable[..., str]


@pytest.fixture(scope="module")
def key(tmp_path_factory: pytest.TempPathFactory) -> SigningKey:
    return new_key(tmp_path_factory.mktemp("organizer") / "season.key")


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory, key: SigningKey) -> Plan:
    """Two submissions on five short matches."""
    folder = tmp_path_factory.mktemp("season")
    for name, direction in (("ada", "observation.step * 9.0"), ("bob", "90.0")):
        (folder / name).mkdir()
        (folder / name / "agent.py").write_text(AGENT.format(direction=direction))
        (folder / name / "submission.toml").write_text(MANIFEST.format(name=name))
    (folder / "tiny.toml").write_text(SUITE)
    return Plan(
        (load_submission(folder / "ada"), load_submission(folder / "bob")),
        ("navigation",),
        read_suite(folder / "tiny.toml"),
        SuiteSeed(0),
        replays="none",
        jobs=1,
        out=folder / "out",
        key=key,
    )


@pytest.fixture(scope="module")
def evaluated(plan: Plan, compiled: None) -> Path:
    run_session(plan, plan.out / "wildscav.db")
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
            run_rescore(forgery.out, 1, key)
        assert refused.value.exit_code != 0
        return f"{capsys.readouterr().err}\n{refused.value}"

    return run


def worst(forgery: Forgery, name: str = "ada") -> int:
    """The match whose loss raises a submission's mean most."""
    rows = forgery.evaluation(name).matches
    return max(rows, key=lambda row: (row.metrics or {})["time"]).index


def test_what_was_really_evaluated_is_borne_out(
    signed: Forgery, key: SigningKey, capsys: pytest.CaptureFixture[str]
) -> None:
    run_rescore(signed.out, 1, key.public)
    said = " ".join(capsys.readouterr().out.split())
    assert "10 records played again: all agree" in said
    assert f"signed with the key {key.public}: nothing was changed or taken out since" in said

    run_rescore(signed.out, 1)
    assert "if that is the organizer's, say so with --key" in capsys.readouterr().out


def test_an_unsigned_folder_is_told_to_prove_no_more_than_it_does(
    unsigned: Forgery, capsys: pytest.CaptureFixture[str]
) -> None:
    run_rescore(unsigned.out, 1)
    assert "not signed: these actions give these scores" in capsys.readouterr().out


def drop(forgery: Forgery) -> None:
    index = worst(forgery)
    forgery.remove_match("ada", index)
    forgery.change_matches("ada", lambda row: None if row.index == index else row)


def blame(forgery: Forgery) -> None:
    for index in range(1, MATCHES):
        forgery.remove_match("ada", index)
    forgery.change_matches("ada", lambda row: blamed_on_platform(row) if row.index else row)


def vanish(forgery: Forgery) -> None:
    for index in range(MATCHES):
        forgery.remove_match("bob", index)
    ada = forgery.evaluation("ada")
    timings = forgery.results.timings
    left = tuple(one for one in timings.matches if one.submission == "ada")
    forgery.tell(evaluations=(ada,), timings=timings.model_copy(update={"matches": left}))


def replace_record(forgery: Forgery) -> None:
    index = worst(forgery)
    before = forgery.evaluation("ada").matches[index].metrics
    metrics = forgery.play_otherwise("ada", index)
    assert metrics != before
    forgery.change_matches("ada", lambda row: with_metrics(row, metrics) if row.index == index else row)


def stricter(forgery: Forgery) -> None:
    forgery.tell(limits={"navigation": KeptLimits(memory=2**30)})


def other_files(forgery: Forgery) -> None:
    forgery.tell_of("ada", digest="0" * 32)


def shut_in(forgery: Forgery) -> None:
    forgery.tell(sandbox="oci")


def excuse(forgery: Forgery) -> None:
    def late(row: MatchRow) -> MatchRow:
        seats = tuple(seat.model_copy(update={"status": "crashed", "fault": "agent"}) for seat in row.seats)
        return MatchRow.of(row.index, seats, row.record)

    forgery.change_matches("bob", late)


def answer_faster(forgery: Forgery) -> None:
    timings = forgery.results.timings
    quick = tuple(one.model_copy(update={"wall": 0.001}) for one in timings.matches)
    forgery.tell(timings=timings.model_copy(update={"matches": quick}))


FORGERIES = {
    "the worst match dropped": (drop, "ada on navigation: match {worst} of the suite is not in the results"),
    "losses blamed on the platform": (
        blame,
        "ada on navigation, match 1: there is no record of it; that the platform failed is shown only by",
    ),
    "a competitor vanished": (
        vanish,
        "bob on navigation: evaluation.json says that it takes part, but there are no results",
    ),
    "a record of other actions": (
        replace_record,
        "navigation-00{worst}-ada: its record is not the one that ledger.jsonl names",
    ),
    "other limits": (
        stricter,
        "results.json says limits {{'navigation': KeptLimits(cpus=None, memory=1073741824",
    ),
    "another submission": (
        other_files,
        "ada on navigation: results.json and evaluation.json name other versions or files of it",
    ),
    "another sandbox": (shut_in, "results.json says sandbox oci, evaluation.json process"),
    "agents that crashed": (excuse, "navigation-000-bob: results.json and ledger.jsonl tell otherwise of it"),
    "quicker agents": (
        answer_faster,
        "navigation-000-ada: results.json and ledger.jsonl tell otherwise of it",
    ),
}


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
    """Results, records, journal, evaluation.json and ledger all tell the same, wrong thing."""
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


@pytest.mark.parametrize("name", ["the worst match dropped", "losses blamed on the platform"])
def test_a_suite_is_demanded_whole_even_of_a_folder_that_is_forged_throughout(
    unsigned: Forgery, rescored: Rescored, name: str
) -> None:
    forge, line = FORGERIES[name]
    index = worst(unsigned)

    forge(unsigned)
    unsigned.rewrite_ledger()

    assert line.format(worst=index) in rescored(unsigned)


def test_only_the_submission_itself_shows_that_it_acted_so(
    plan: Plan, unsigned: Forgery, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ada = plan.submissions[0]
    path = unsigned.out / "records" / f"navigation-{worst(unsigned):03d}-ada.wsr"
    run_again(path, ada, seats=[], logs=tmp_path, sandbox="process")
    assert "seat 0 (ada): all 30 steps as recorded" in capsys.readouterr().out

    replace_record(unsigned)
    unsigned.rewrite_ledger()
    run_rescore(unsigned.out, 1)  # nobody signed it, and every file tells the same

    with pytest.raises(
        UserError, match=r"seat 0 \(ada\) acts otherwise than recorded in .* first in step 1:"
    ):
        run_again(path, ada, seats=[], logs=tmp_path, sandbox="process")
    assert "warning" not in capsys.readouterr().out
    other = replace(ada, digest="0" * 32)
    with pytest.raises(UserError, match="acts otherwise"):
        run_again(path, other, seats=[], logs=tmp_path, sandbox="process")
    assert "warning: these are not the files of ada that were evaluated" in capsys.readouterr().out


def claim_less_time(content: dict[str, object]) -> None:
    content["at"] = "2020-01-01T00:00:00.000+00:00"


def test_no_line_of_a_signed_ledger_can_be_changed_or_taken_out(
    signed: Forgery, rescored: Rescored, key: SigningKey
) -> None:
    path = signed.out / LEDGER_FILE
    whole = path.read_bytes()
    lines = whole.splitlines(keepends=True)

    signed.edit_ledger(3, claim_less_time)
    assert "ledger.jsonl, line 5: does not follow the line before" in rescored(signed, key.public)

    path.write_bytes(whole)
    signed.edit_ledger(len(lines) - 1, claim_less_time)
    assert f"line {len(lines)}: its signature is not that of the key" in rescored(signed, key.public)

    path.write_bytes(b"".join(lines[:3] + lines[4:]))
    assert "ledger.jsonl, line 4: does not follow the line before" in rescored(signed, key.public)

    path.write_bytes(b"".join(lines[:-1]))
    assert "ledger.jsonl is not closed" in rescored(signed, key.public)

    path.write_bytes(whole[:-10])
    assert "ends in the middle of a line" in rescored(signed, key.public)

    path.write_bytes(whole.replace(b'"at":', b'"at": ', 1))
    assert "line 1: is not in canonical JSON" in rescored(signed, key.public)

    path.unlink()
    assert "nothing there is signed" in rescored(signed, key.public)
    assert "nothing shows that nothing was left out" in rescored(signed)


def test_results_and_identity_cannot_be_taken_away(signed: Forgery, rescored: Rescored) -> None:
    results = (signed.out / "results.json").read_bytes()
    (signed.out / "results.json").unlink()
    assert "though the ledger says that the evaluation came to results" in rescored(signed)

    (signed.out / "results.json").write_bytes(results)
    (signed.out / "evaluation.json").unlink()
    assert "nothing says who was to play" in rescored(signed)


def test_results_that_tell_what_there_is_not_are_one_clear_line(signed: Forgery, rescored: Rescored) -> None:
    ada, bob = signed.results.evaluations

    signed.tell(evaluations=(ada, bob, bob))
    assert "bob is in it twice on navigation" in rescored(signed)

    signed.tell(evaluations=(ada.model_copy(update={"track": "chess"}), bob))
    assert "there is no track 'chess'" in rescored(signed)

    signed.tell(evaluations=(ada, bob.model_copy(update={"track": "royale"})))
    assert "match 0 is in the results, but the suite has only 0" in rescored(signed)


def test_an_edited_journal_does_not_get_into_the_results(plan: Plan, unsigned: Forgery) -> None:
    unsigned_plan = replace(plan, key=None, out=unsigned.out)
    better = with_metrics(
        unsigned.evaluation("ada").matches[0],
        {"time": 0.1, "used_time": 0.1, "punish_time": 0.0, "success": 1.0},
    )
    forge = {"matches": unsigned.rewrite_journal, "and the ledger": unsigned.rewrite_ledger}
    unsigned.change_matches("ada", lambda row: better if row.index == 0 else row)

    said = []
    for rewrite in forge.values():
        rewrite()
        with pytest.raises(UserError) as refused:
            run_session(unsigned_plan, unsigned.out / "wildscav.db")
        assert refused.value.exit_code == 2
        said.append(str(refused.value))

    assert "the journal says otherwise of navigation-000-ada than the ledger" in said[0]
    assert "the metrics of navigation-000-ada in the journal are not those of its record" in said[1]


def test_a_signed_evaluation_goes_on_only_with_its_key(plan: Plan, signed: Forgery, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"it is signed with the key .*, not unsigned"):
        run_session(replace(plan, key=None, out=signed.out), signed.out / "wildscav.db")
    other = new_key(tmp_path / "other.key")
    with pytest.raises(UserError, match=f"not signed with the key {other.public}"):
        run_session(replace(plan, key=other, out=signed.out), signed.out / "wildscav.db")

    before = (signed.out / LEDGER_FILE).read_bytes()
    run_session(replace(plan, out=signed.out), signed.out / "wildscav.db")
    assert (signed.out / LEDGER_FILE).read_bytes() == before, "nothing happened that was to be entered"


def test_a_loss_cannot_be_removed_to_be_played_again(plan: Plan, signed: Forgery) -> None:
    signed.remove_match("ada", worst(signed))

    with pytest.raises(
        UserError, match=r"the record or the journal of navigation-00.-ada is missing, or was changed"
    ):
        run_session(replace(plan, out=signed.out), signed.out / "wildscav.db")


def test_a_platform_fault_that_the_organizer_signed_is_borne_out(
    signed: Forgery, key: SigningKey, rescored: Rescored, capsys: pytest.CaptureFixture[str]
) -> None:
    blame(signed)
    timings = signed.results.timings
    left = tuple(one for one in timings.matches if one.submission == "bob" or one.index == 0)
    signed.tell(timings=timings.model_copy(update={"matches": left}))
    signed.rewrite_ledger(key)  # as the evaluation itself writes it when the platform fails
    capsys.readouterr()

    run_rescore(signed.out, 1, key.public)

    assert "6 records played again: all agree" in capsys.readouterr().out
    assert "is shown only by a ledger that the organizer signed" in rescored(signed)


def test_the_ledger_tells_the_whole_evaluation(signed: Forgery, key: SigningKey) -> None:
    ledger = read_ledger(signed.out)

    assert ledger is not None
    assert ledger.key == key.public
    assert ledger.identity == signed.identity
    assert sorted(ledger.played) == sorted(path.stem for path in (signed.out / "records").iterdir())
    assert ledger.broken_off == {}
    closed = ledger.closed
    assert isinstance(closed, Closed)
    assert [(one.submission, one.summary) for one in closed.scores] == [
        (one.submission, one.score) for one in signed.results.evaluations
    ]


def test_verify_asks_whether_records_are_those_that_were_played(
    signed: Forgery, key: SigningKey, capsys: pytest.CaptureFixture[str]
) -> None:
    records = sorted((signed.out / "records").iterdir())
    verify(records[:2], key=key.public)
    verify(records[:1])

    with pytest.raises(UserError, match=f"is signed with the key {key.public}, not with {'ab' * 32}"):
        verify(records[:1], key="ab" * 32)
    with pytest.raises(UserError, match="the public key nonsense cannot be read") as refused:
        verify(records[:1], key="nonsense")
    assert refused.value.exit_code == 2

    # Bob's record under ada's name; one of other actions under its own; one of a match that nobody played.
    records[0].write_bytes(records[-1].read_bytes())
    signed.play_otherwise("ada", 1)
    stray = signed.out / "records" / "navigation-007-bob.wsr"
    stray.write_bytes(records[-1].read_bytes())
    capsys.readouterr()
    with pytest.raises(UserError, match="3 of 4 records do not hold"):
        verify([records[0], records[2], records[-1], stray])
    said = " ".join(capsys.readouterr().out.split())
    assert "it is under another's name: seat 0 is that of bob, not of ada" in said
    assert "it is not the record that ledger.jsonl has of it" in said
    assert "ledger.jsonl knows no such match" in said


def test_the_command_ends_with_an_exit_code_and_a_line(
    signed: Forgery, key: SigningKey, wildscav: Callable[..., "subprocess.CompletedProcess[str]"]
) -> None:
    shut_in(signed)

    done = wildscav("rescore", signed.out, "--key", key.public, "--jobs", 1)

    assert done.returncode == 1
    assert "wildscav: results.json says sandbox oci, evaluation.json process" in done.stderr
