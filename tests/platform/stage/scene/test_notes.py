"""Notes are found in the logs beside a record, and shown in centimetres and frames."""

from pathlib import Path

import pytest
from tests.recorded_matches import SMALL_MAP

from wildscav.errors import UserError
from wildscav.notes import Note, note_line
from wildscav_engine.record import read_record, write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_stage.scene.notes import notes_beside, shown_notes

SEATS = ("fighter", "submission", "submission")


@pytest.fixture
def record(tmp_path: Path) -> Path:
    """A record in the folder of an evaluation, of a match whose last two seats have agents."""
    match = Match(MatchSpec(track="battle", map=SMALL_MAP, seats=SEATS, time_limit=0.5))
    match.play_out()
    path = tmp_path / "records" / "battle-000.wsr"
    path.parent.mkdir()
    write_record(path, match, ["fighter", "owl", "newt"])
    (tmp_path / "logs").mkdir()
    return path


def log(path: Path, *texts: str) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_text("".join(note_line(step, say=text) for step, text in enumerate(texts)))
    return path


def said(record: Path, logs: Path | None = None) -> list[tuple[int, int, str]]:
    found = notes_beside(record, read_record(record), logs)
    return [(note.seat, note.step, note.text) for note in found]


def test_the_logs_of_an_evaluation_belong_to_their_seats(record: Path) -> None:
    logs = record.parents[1] / "logs"
    assert said(record) == []
    log(logs / "battle-000.seat-1.log", "one", "two")
    log(logs / "battle-000.seat-2.log", "three")
    log(logs / "battle-001.seat-2.log", "of another match")
    assert said(record) == [(1, 0, "one"), (2, 0, "three"), (1, 1, "two")]


def test_a_log_that_happens_to_lie_there_is_left_out(record: Path) -> None:
    log(record.with_name("battle-000.seat-0.log"), "a robot says nothing")
    log(record.with_name("battle-000.log"), "whose?")
    assert said(record) == []


def test_a_folder_of_logs_may_be_named_whose_names_begin_with_the_seat(record: Path, tmp_path: Path) -> None:
    log(tmp_path / "mine" / "2-newt.log", "three")
    assert said(record, tmp_path / "mine") == [(2, 0, "three")]


def test_what_is_said_after_the_match_is_not_shown(record: Path, tmp_path: Path) -> None:
    steps = read_record(record).steps
    log(tmp_path / "1-owl.log", *["now"] * (steps + 3))
    assert len(said(record, tmp_path / "1-owl.log")) == steps


@pytest.mark.parametrize("name", ["agent.log", "0-fighter.log", "7-nobody.log"])
def test_a_log_that_is_of_no_seat_with_an_agent_is_refused(record: Path, tmp_path: Path, name: str) -> None:
    log(tmp_path / name, "who?")
    with pytest.raises(UserError, match=r"must say of which seat it is.* 1, 2"):
        said(record, tmp_path / name)


def test_a_log_that_is_not_there_is_one_clear_error(record: Path, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cannot read .*1-owl\.log: No such file"):
        said(record, tmp_path / "1-owl.log")


def test_pages_get_frames_and_centimetres() -> None:
    note = Note(1, 7, name="goal", points=((1.006, 2.0, -3.0),))
    (shown,) = shown_notes([note], 5).notes
    assert (shown.frame, shown.points) == (35, ((101, 200, -300),))
