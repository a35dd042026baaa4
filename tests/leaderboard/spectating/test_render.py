"""What the process that renders shows of a match besides its record."""

from pathlib import Path

from tests.recorded_matches import SMALL_MAP

from wildscav.notes import note_line
from wildscav_engine.record import read_record, write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_leaderboard.spectating.render import public_notes
from wildscav_leaderboard.spectating.render_cache import QUIET


def test_a_video_shows_what_is_public_unless_an_organizer_hides_it(tmp_path: Path) -> None:
    match = Match(MatchSpec(track="battle", map=SMALL_MAP, seats=("submission", "fighter"), time_limit=0.5))
    match.play_out()
    record = tmp_path / "records" / "battle-000-owl.wsr"
    (tmp_path / "records").mkdir()
    (tmp_path / "logs").mkdir()
    write_record(record, match, ["owl", "fighter"])
    said = note_line(0, say="Good luck!", public=True) + note_line(1, say="He is slow.")
    (tmp_path / "logs" / "battle-000-owl.log").write_text(said)
    played = read_record(record)

    assert [note.text for note in public_notes(record, played, Path("7.video-2.mp4"))] == ["Good luck!"]
    assert public_notes(record, played, Path(f"7{QUIET}.video-2.mp4")) == []
