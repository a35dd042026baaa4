"""A signed ledger: kept over several sittings, continued with its key alone, and no line can be changed."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.interrupted_runs import contents
from tests.evaluator.ledger.forgeries import blame, worst
from tests.evaluator.ledger.forging import Forgery, Rescored, with_metrics
from tests.evaluator.results_by_hand import identity_of
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.cli.sessions.verify_records import verify_records
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ledger.entries import Closed, MatchStarted, Resumed
from wildscav_evaluator.ledger.keys import SigningKey, new_key
from wildscav_evaluator.ledger.ledger import Ledger, LedgerError, parse_ledger, read_ledger
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.output.identity import Identity
from wildscav_evaluator.output.json_files import LARGEST
from wildscav_evaluator.output.layout import LEDGER_FILE
from wildscav_evaluator.plans.evaluation import EvaluationPlan


def ledger_of(out: Path) -> Ledger:
    ledger = read_ledger(out)
    assert ledger is not None
    return ledger


@pytest.fixture
def identity(key: SigningKey) -> Identity:
    return identity_of("ada", key=key.public)


def test_a_ledger_goes_on_where_a_killed_one_ended(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    path = tmp_path / LEDGER_FILE
    first = LedgerWriter(tmp_path, identity, key)
    first.begin("navigation-000-ada")
    whole = path.read_bytes()
    path.write_bytes(whole + b'{"at":"2030-01-01T00:00')  # killed while it wrote the next entry

    second = LedgerWriter(tmp_path, identity, key)
    second.begin("navigation-000-ada")

    assert path.read_bytes().startswith(whole)
    ledger = ledger_of(tmp_path)
    assert [type(entry.fact) for entry in ledger.entries[1:]] == [MatchStarted, Resumed, MatchStarted]
    assert ledger.head == second.head
    assert ledger.interrupted == {"navigation-000-ada": 1}, "a try that was interrupted does not vanish"


def test_a_match_that_the_platform_broke_was_not_interrupted(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    keeper = LedgerWriter(tmp_path, identity, key)
    for _ in range(2):
        keeper.begin("navigation-000-ada")
        keeper.broke("navigation-000-ada", "the worker process died (SIGKILL)")

    ledger = ledger_of(tmp_path)
    assert ledger.interrupted == {}
    assert len(ledger.entries) == 5


def test_a_ledger_killed_in_its_first_line_begins_again(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    (tmp_path / LEDGER_FILE).write_bytes(b'{"at":')

    LedgerWriter(tmp_path, identity, key)

    assert ledger_of(tmp_path).identity == identity


def test_no_text_in_a_ledger_can_steer_a_terminal(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    reason = "no \x1b[31m memory \u202e left \x7f, für 😀"
    LedgerWriter(tmp_path, identity, key).broke("navigation-000-ada", reason)

    line = (tmp_path / LEDGER_FILE).read_bytes().splitlines()[-1]

    assert line.isascii()
    assert line.decode().isprintable()
    assert getattr(ledger_of(tmp_path).entries[-1].fact, "reason", "") == reason


def test_nothing_goes_on_in_a_ledger_that_was_changed(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    keeper = LedgerWriter(tmp_path, identity, key)
    for number in range(3):
        keeper.begin(f"navigation-00{number}-ada")
    path = tmp_path / LEDGER_FILE
    lines = path.read_bytes().splitlines(keepends=True)

    path.write_bytes(b"".join([*lines[:1], *lines[2:]]))
    with pytest.raises(UserError, match=r"line 2: does not follow the previous line.*--fresh"):
        LedgerWriter(tmp_path, identity, key)
    with pytest.raises(LedgerError, match="line 2: does not follow"):
        read_ledger(tmp_path)

    path.write_bytes(b"".join(lines))
    with pytest.raises(UserError, match="is of another evaluation"):
        LedgerWriter(tmp_path, identity.model_copy(update={"seed": "7"}), key)


def test_a_ledger_that_is_too_large_is_not_said_to_be_changed(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    with (tmp_path / LEDGER_FILE).open("wb") as file:
        file.truncate(LARGEST + 1)
    with pytest.raises(UserError, match=r"it has more than [\d,]+ bytes: it cannot be continued"):
        LedgerWriter(tmp_path, identity, key)


def claim_less_time(content: dict[str, object]) -> None:
    content["at"] = "2020-01-01T00:00:00.000+00:00"


def test_no_line_of_a_signed_ledger_can_be_changed_or_taken_out(
    signed: Forgery, rescored: Rescored, key: SigningKey
) -> None:
    path = signed.out / LEDGER_FILE
    whole = path.read_bytes()
    lines = whole.splitlines(keepends=True)

    signed.edit_ledger(3, claim_less_time)
    assert "ledger.jsonl, line 5: does not follow the previous line" in rescored(signed, key.public)

    path.write_bytes(whole)
    signed.edit_ledger(len(lines) - 1, claim_less_time)
    assert f"line {len(lines)}: its signature is not that of the key" in rescored(signed, key.public)

    path.write_bytes(b"".join(lines[:3] + lines[4:]))
    assert "ledger.jsonl, line 4: does not follow the previous line" in rescored(signed, key.public)

    path.write_bytes(b"".join(lines[:-1]))
    assert "ledger.jsonl is not closed" in rescored(signed, key.public)

    path.write_bytes(whole[:-10])
    assert "ends in the middle of a line" in rescored(signed, key.public)

    path.write_bytes(whole.replace(b'"at":', b'"at": ', 1))
    assert "line 1: is not in canonical JSON" in rescored(signed, key.public)

    path.unlink()
    assert "nothing there is signed" in rescored(signed, key.public)
    assert "nothing shows that no match was left out" in rescored(signed)


def test_a_platform_fault_that_the_organizer_signed_is_borne_out(
    signed: Forgery, key: SigningKey, rescored: Rescored, capsys: pytest.CaptureFixture[str]
) -> None:
    blame(signed)
    timings = signed.results.timings
    left = tuple(one for one in timings.matches if one.submission == "bob" or one.index == 0)
    signed.tell(timings=timings.model_copy(update={"matches": left}))
    signed.rewrite_ledger(key)  # as the evaluation itself writes it when the platform fails
    capsys.readouterr()

    run_rescore(signed.out, LocalExecutor(1), key.public)

    assert "6 records played again: all agree" in capsys.readouterr().out
    assert "only a ledger that the organizer signed" in rescored(signed)


def test_the_ledger_tells_the_whole_evaluation(signed: Forgery, key: SigningKey) -> None:
    ledger = ledger_of(signed.out)
    assert ledger.key == key.public
    assert ledger.identity == signed.identity
    assert sorted(ledger.played) == sorted(path.stem for path in (signed.out / "records").iterdir())
    assert ledger.interrupted == {}
    closed = ledger.closed
    assert isinstance(closed, Closed)
    assert [(one.submission, one.summary) for one in closed.scores] == [
        (one.submission, one.score) for one in signed.results.evaluations
    ]


def test_verify_asks_whether_records_are_those_that_were_played(
    signed: Forgery, key: SigningKey, capsys: pytest.CaptureFixture[str]
) -> None:
    records = sorted((signed.out / "records").iterdir())
    verify_records(records[:2], key=key.public)
    verify_records(records[:1])

    with pytest.raises(UserError, match=f"is signed with the key {key.public}, not with {'ab' * 32}"):
        verify_records(records[:1], key="ab" * 32)
    with pytest.raises(UserError, match="the public key nonsense cannot be read") as refused:
        verify_records(records[:1], key="nonsense")
    assert refused.value.exit_code == 2

    # Bob's record under ada's name; one of other actions under its own; one of a match that nobody played.
    records[0].write_bytes(records[-1].read_bytes())
    signed.play_otherwise("ada", 1)
    stray = signed.out / "records" / "navigation-007-bob.wsr"
    stray.write_bytes(records[-1].read_bytes())
    capsys.readouterr()
    with pytest.raises(UserError, match="3 of 4 records do not hold"):
        verify_records([records[0], records[2], records[-1], stray])
    said = " ".join(capsys.readouterr().out.split())
    assert "its file has the name of another record: seat 0 belongs to bob, not to ada" in said
    assert "ledger.jsonl has the digest of another record" in said
    assert "ledger.jsonl has no such match" in said


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
    with pytest.raises(UserError, match=r"it is signed with the key .*, not unsigned") as refused:
        run_session(replace(plan, key=None, out=signed.out))
    assert refused.value.exit_code == 2
    other = new_key(tmp_path / "other.key")
    with pytest.raises(UserError, match=f"not signed with the key {other.public}"):
        run_session(replace(plan, key=other, out=signed.out))

    before = contents(signed.out)
    run_session(replace(plan, out=signed.out, jobs=plan.jobs + 1))
    assert contents(signed.out) == before, "nothing was played, so there is nothing to enter"


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
