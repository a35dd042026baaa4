"""What is given up or judged again under an edition, and how a season ends that has had several."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import select
from tests.leaderboard.conductor.conducted import Conducted
from tests.leaderboard.conductor.edited import (
    EDITS,
    apply,
    counts,
    edit,
    finalize,
    play,
    played_by_two,
    ranked,
)

from wildscav.errors import UserError
from wildscav_leaderboard.boards.documents import SuiteBoard
from wildscav_leaderboard.conductor.editions import (
    edition_changes,
)
from wildscav_leaderboard.matches.models import FINAL, FINISHED, SUITE, VOID, WAITING, Match
from wildscav_leaderboard.organizing import finalizing
from wildscav_leaderboard.organizing.acts import ACTS
from wildscav_leaderboard.organizing.checking import check_rules
from wildscav_leaderboard.publishing.service import board_lines
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import SECRET_FILE, Season
from wildscav_leaderboard.seasons.in_force import edition_numbers, in_force
from wildscav_leaderboard.seasons.initial_files import COMMITMENTS_FILE, commitments_text
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.seasons.refusals import RefusalError


@pytest.fixture
def season(tmp_path: Path) -> Iterator[Conducted]:
    with played_by_two(tmp_path) as played:
        yield played


def lose_a_match(season: Conducted) -> int:
    """Let a match of the owls' newest submission be given up; return the submission."""
    number = season.active("owls")
    season.take_matches(1)
    season.write(lambda session: give_up(session.scalars(select(Match).where(Match.state != FINISHED)).all()))
    return number


def give_up(matches: object) -> None:
    for match in matches:  # type: ignore[attr-defined]
        match.state, match.deadline, match.detail = VOID, None, "given up"


def test_a_season_does_not_end_while_somebody_would_drop_out(season: Conducted) -> None:
    number, later = lose_a_match(season), season.season.settings.closes

    def advance(*left_out: int) -> str:
        with season.database.writing() as session:
            finalizing.begin(session, season.season, "anna", 1, later, early=False)
            if left_out:
                finalizing.leave_out(session, "anna", left_out, "the disk of its host was lost", later)
            return finalizing.advance(session, season.season, "anna", later).stage

    with pytest.raises(RefusalError, match=rf"runner-{number} of owls \(0 of 2 matches of navigation\)"):
        advance()
    assert advance(number) == finalizing.DECIDING
    with season.database.reading() as session:
        (entry,) = session.scalars(select(AuditEntry).filter_by(act="leave out")).all()
        assert (entry.subject, entry.detail) == (f"submission {number}", "the disk of its host was lost")
    season.refresh()
    found = season.board("navigation")
    assert found is not None
    assert number not in found.entered


def test_another_secret_is_refused_wherever_it_would_be_used(season: Conducted) -> None:
    folder = season.season.folder
    secrets = [(folder / name).read_bytes() for name in (SECRET_FILE, "final-secret.txt")]
    (folder / COMMITMENTS_FILE).write_text(commitments_text(*secrets))
    assert check_rules(season.season) == []
    (folder / SECRET_FILE).write_bytes(secrets[1])
    other = Season.open(folder)
    with pytest.raises(UserError, match="the secrets do not have the commitments"):
        check_rules(other)
    with season.database.writing() as session:
        with pytest.raises(RefusalError, match="the secrets do not have the commitments"):
            finalizing.begin(session, other, "anna", 1, season.season.settings.closes, early=False)
        with pytest.raises(RefusalError, match="whose commitments were published"):
            edition_changes(session, other)


def test_an_entry_is_judged_again_and_its_old_results_are_kept(season: Conducted) -> None:
    def rejudge(**what: str) -> None:
        season.act(ACTS["rejudge"], reason="a disk failed", **what)

    rejudge(submission="1")
    with pytest.raises(RefusalError, match="all are judged again already"):
        rejudge(submission="1")
    assert ranked(season) == [("foxes", 2), ("owls", 2)], "the old results count until then"
    assert play(season, 9.0) == 2
    found = season.board("navigation")
    assert isinstance(found, SuiteBoard)
    means = {row.team: row.metrics["time"].mean for row in found.rows}
    assert means == {"foxes": 9.0, "owls": 1.0}
    assert counts(season) == {FINISHED: 6}
    with season.database.reading() as session:
        lines = [line.match for line in board_lines(session, in_force(session, season.season), "navigation")]
        played = [(one.judging, one.superseded) for one in lines if one is not None and one.submission == 1]
        (entry,) = session.scalars(select(AuditEntry).filter_by(act="rejudge")).all()
    assert sorted(played) == [(1, True), (1, True), (2, False), (2, False)]
    assert entry.detail == "submissions 1 on the tracks all: a disk failed"
    with pytest.raises(RefusalError, match="nobody has played on 'chess'"):
        rejudge(track="chess")


def test_what_was_given_up_is_run_again_under_the_edition_in_force_alone(season: Conducted) -> None:
    number = lose_a_match(season)
    edit(season, *EDITS["the suite"])
    apply(season)

    def rerun() -> None:
        season.act(ACTS["rerun"], number)

    with pytest.raises(RefusalError, match="none of its matches was given up"):
        rerun()
    own = select(Match).filter_by(group_id=number, kind=SUITE)
    in_use = season.write(edition_numbers)["navigation"]
    season.write(lambda session: give_up(session.scalars(own.filter_by(edition_id=in_use)).all()))
    rerun()
    with season.database.reading() as session:
        states = {(match.edition_id == in_use, match.state) for match in session.scalars(own)}
    assert states == {(True, WAITING), (False, VOID)}


def test_an_end_that_is_taken_back_leaves_nothing_in_the_way_of_another_one(season: Conducted) -> None:
    assert finalize(season, best=2).planned == 4
    (taken, _), *_ = season.take_matches(1)
    assert season.played(taken)
    edit(season, *EDITS["the sandbox"])
    with pytest.raises(RefusalError, match=r"take the end back .* and have all entries judged again"):
        finalize(season)
    file, old, new = EDITS["the sandbox"]
    edit(season, file, new, old)
    season.write(lambda session: finalizing.abort(session, "anna", season.now))
    edit(season, *EDITS["the suite"])
    apply(season)
    assert play(season) == 4
    assert finalize(season).planned == 2, "the best one's, under the edition in force"
    assert play(season) == 2
    assert finalize(season).stage == finalizing.DONE


def test_an_entry_may_be_left_out_when_its_final_matches_were_given_up(season: Conducted) -> None:
    assert finalize(season, best=2).planned == 4
    lost = select(Match).filter_by(kind=FINAL, group_id=1)
    season.write(lambda session: give_up(session.scalars(lost).all()))
    play(season)
    with pytest.raises(RefusalError, match="final matches of 1 were given up"):
        finalize(season)
    season.write(lambda session: finalizing.leave_out(session, "anna", [1], "it was asked for", season.now))
    assert finalize(season).stage == finalizing.DONE
    assert ranked(season) == [("owls", 2)]


def test_nothing_can_be_applied_once_final_matches_are_played(season: Conducted) -> None:
    with pytest.raises(RefusalError, match="there is nothing to apply"):
        apply(season)
    season.write(
        lambda session: season_state.write_state(
            session, season_state.FINALIZING, {"at": "", "best": 1, "field": {}}, season.now
        )
    )
    with pytest.raises(RefusalError, match="no rule may change now"):
        apply(season)
