"""What a signed ledger holds, and that no line of it can be changed."""

import pytest
from tests.evaluator.ledger.forgeries import blame
from tests.evaluator.ledger.forging import Forgery, Rescored

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.cli.sessions.verify_records import verify_records
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ledger.entries import Closed
from wildscav_evaluator.ledger.keys import SigningKey
from wildscav_evaluator.ledger.ledger import read_ledger
from wildscav_evaluator.output.layout import LEDGER_FILE


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
    ledger = read_ledger(signed.out)

    assert ledger is not None
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
