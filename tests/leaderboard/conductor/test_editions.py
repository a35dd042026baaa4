"""The rules of a season are versions: an edit shows its effect, waits to be applied, and empties no board."""

from collections.abc import Iterator
from pathlib import Path
from shutil import make_archive

import pytest
from sqlalchemy import func, select
from tests.commands import run_command
from tests.leaderboard.agents import write_agent
from tests.leaderboard.conductor.conducted import Conducted, conducting
from tests.leaderboard.seasons_made import make_season

from wildscav.errors import UserError
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.boards.documents import SuiteBoard
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.conductor.editions import (
    EditionChange,
    apply_editions,
    begin_editions,
    edition_changes,
)
from wildscav_leaderboard.matches.models import FINAL, FINISHED, SUITE, VOID, WAITING, Match
from wildscav_leaderboard.matches.service import NOT_IN_FORCE
from wildscav_leaderboard.organizing import finalizing
from wildscav_leaderboard.organizing.acts import ACTS
from wildscav_leaderboard.organizing.checking import check_rules, check_season, entries_without_model
from wildscav_leaderboard.organizing.status import status
from wildscav_leaderboard.publishing.service import board_lines
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import SECRET_FILE, Season
from wildscav_leaderboard.seasons.in_force import edition_numbers, in_force
from wildscav_leaderboard.seasons.initial_files import COMMITMENTS_FILE, commitments_text
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE
from wildscav_leaderboard.visibility import PUBLIC, audience_of
from wildscav_leaderboard.web.boards import _rendered


@pytest.fixture
def season(tmp_path: Path) -> Iterator[Conducted]:
    """A season in which the foxes and the owls have played navigation."""
    with conducting(make_season(tmp_path / "season")) as conducted:
        conducted.active("foxes")
        conducted.active("owls")
        play(conducted)
        yield conducted


def play(season: Conducted, score: float = 1.0) -> int:
    """Play whatever waits and can be played, and bring the boards up to date; return how many matches."""
    count = 0
    while taken := season.take_matches(8):
        for attempt, _ in taken:
            season.wait(1)
            assert season.played(attempt, score)
        count += len(taken)
    season.refresh()
    return count


def edit(season: Conducted, file: str, old: str, new: str) -> list[EditionChange]:
    """Edit a file, and start the season again."""
    rewrite(season, file, old, new)
    return season.write(lambda session: begin_editions(session, season.season, season.now))


def rewrite(season: Conducted, file: str, old: str, new: str) -> None:
    """Edit a file, without the conductor's knowledge."""
    path = season.season.folder / file
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    season.season = Season.open(season.season.folder)


def apply(season: Conducted) -> list[EditionChange]:
    return season.write(lambda session: apply_editions(session, season.season, "anna", season.now))


def ranked(season: Conducted, audience: str = PUBLIC) -> list[tuple[str, int]]:
    """The teams that have a rank, and their matches."""
    found = season.board("navigation", audience)
    return [] if found is None else [(row.team, row.matches) for row in found.rows if row.rank is not None]


def counts(season: Conducted) -> dict[str, int]:
    with season.database.reading() as session:
        found = session.execute(select(Match.state, func.count()).group_by(Match.state))
        return {state: count for state, count in found}  # noqa: C416


EDITS = {
    "the suite": ("tiny.toml", "time_limit = 4 }\n\n[tracks.battle]", "time_limit = 5 }\n\n[tracks.battle]"),
    "rounds": (
        SETTINGS_FILE,
        'suite = "tiny.toml"\n\n[tracks.battle]',
        'suite = "tiny.toml"\nrounds = 2\n\n[tracks.battle]',
    ),
    "limits": ("tiny.toml", "[tracks.battle]", 'limits = { memory = "128MiB" }\n\n[tracks.battle]'),
    "a model": (SETTINGS_FILE, "[quotas]", '[model]\nurl = "http://host/v1"\nname = "tiny"\n\n[quotas]'),
    "the sandbox": (SETTINGS_FILE, 'sandbox = "process"', 'sandbox = "bubblewrap"'),
}


def test_entries_that_ask_a_model_are_named_once_the_settings_offer_none(
    season: Conducted, tmp_path: Path
) -> None:
    def lines() -> list[str]:
        return season.write(lambda session: list(entries_without_model(session, season.season)))

    file, before, after = EDITS["a model"]
    with (write_agent(tmp_path, "asker") / "submission.toml").open("a") as manifest:
        manifest.write("model = true\n")
    archive = season.season.archives / season.submission(1).archive
    make_archive(str(archive.with_suffix("")), "zip", tmp_path / "asker")
    assert lines() == []  # it never offered one
    edit(season, file, before, after)
    apply(season)
    assert lines() == []

    edit(season, file, after, before)
    said = "submission 1, runner 1, asks a language model, and the settings offer none"
    assert [line.partition(":")[0] for line in lines()] == [said]
    apply(season)
    assert any(said in line for line in check_season(season.season.folder).problems)


@pytest.mark.parametrize("what", EDITS)
def test_an_edit_drops_nobody_until_it_is_applied(season: Conducted, what: str) -> None:
    before = season.board("navigation")
    assert ranked(season) == [("foxes", 2), ("owls", 2)]

    change = edit(season, *EDITS[what])[0]

    assert (change.track, change.entries) == ("navigation", 2)
    assert "these 2 entries have to be judged again: about 4 seconds" in change.text or what == "rounds"
    season.refresh()
    assert season.board("navigation") == before, "the old edition goes on"

    old = season.write(edition_numbers)["navigation"]
    apply(season)
    season.refresh()
    assert ranked(season, audience_of(old)) == [("foxes", 2), ("owls", 2)], "old results stay on their board"
    if what == "the sandbox":
        return  # this process plays in another one
    each = 4 if what == "rounds" else 2
    assert play(season) == 2 * each
    assert ranked(season) == [("foxes", each), ("owls", each)]
    with season.database.reading() as session:
        acts = session.scalars(select(AuditEntry).filter_by(act="apply")).all()
    assert acts[0].subject.endswith(" of navigation")


def test_matches_that_wait_are_played_by_the_edition_that_counts_them(season: Conducted) -> None:
    season.active("foxes")
    edit(season, *EDITS["the suite"])
    taken = season.take_matches(1)
    assert [match.spec["time_limit"] for _, match in taken] == [4], "that of the edition in force"
    apply(season)
    assert counts(season)[VOID] == 1, "what waited under the old edition is given up"
    assert season.played(taken[0][0]), "what was being played ends"
    (match,) = (season.match(match.id) for _, match in taken)
    season.refresh()
    found = season.board("navigation", audience_of(match.edition_id or 0))
    assert found is not None
    assert sorted(row.matches for row in found.rows) == [2, 2], "each team's best one"
    assert 3 in found.entered, "and counts where it was planned"
    assert {match.spec["time_limit"] for _, match in season.take_matches(9)} == {5}


@pytest.mark.parametrize("how", ["lost", "broken", "paused", "of an old database"])
def test_a_match_whose_edition_ends_while_it_is_played_never_waits_for_ever(tmp_path: Path, how: str) -> None:
    with conducting(make_season(tmp_path / "season", "matches = 2")) as season:
        for team in ("foxes", "owls"):
            season.active(team, ("battle",))
        season.plan()
        ((attempt, match),) = season.take_matches(1, begun=how != "paused")
        edit(season, "tiny.toml", "match = { time_limit = 4, seats", "match = { time_limit = 5, seats")
        apply(season)

        if how == "broken":
            season.broke(attempt.id)
        elif how == "paused":
            season.act(ACTS["pause"], reason="a move")
            assert not season.begin(attempt)
            season.act(ACTS["resume"])
        else:
            season.take_over()
            season.expire()
        if how == "of an old database":
            season.write(lambda session: let_wait(session.get_one(Match, match.id)))
            season.take_over()

        assert (season.match(match.id).state, season.match(match.id).detail) == (VOID, NOT_IN_FORCE)
        while season.plan():
            play(season)
        board = season.board("battle")
        assert board is not None
        assert {row.team for row in board.rows if row.matches >= 2} >= {"foxes", "owls"}
        assert finalize(season).stage == finalizing.DECIDING


def let_wait(match: Match) -> None:
    match.state, match.detail = WAITING, ""


def finalize(season: Conducted, best: int = 1) -> finalizing.Ending:
    later = season.season.settings.closes
    with season.database.writing() as session:
        finalizing.begin(session, season.season, "anna", best, later, early=False)
        return finalizing.advance(session, season.season, "anna", later)


def test_an_edit_that_is_undone_brings_the_old_results_back(season: Conducted) -> None:
    before = ranked(season)
    file, old, new = EDITS["the suite"]
    edit(season, file, old, new)
    apply(season)
    edit(season, file, new, old)
    apply(season)
    assert play(season) == 0, "all of it was played before"
    assert ranked(season) == before


def test_a_ladder_whose_edition_comes_back_goes_on_where_it_was(tmp_path: Path) -> None:
    with conducting(make_season(tmp_path / "season", "matches = 4")) as season:
        for team in ("foxes", "owls"):
            season.active(team, ("battle",))
        season.plan()
        assert season.played(season.take_matches(1)[0][0])
        for times in ("45", "54"):
            old, new = (f"match = {{ time_limit = {time}, seats" for time in times)
            edit(season, "tiny.toml", old, new)
            apply(season)
            while play(season) + season.plan():
                pass
        board = season.board("battle")
        assert board is not None
        assert {row.team for row in board.rows if row.matches >= 4} >= {"foxes", "owls"}


def test_rules_may_be_edited_freely_while_nobody_has_played(tmp_path: Path) -> None:
    with conducting(make_season(tmp_path / "season")) as season:
        assert edit(season, *EDITS["the suite"]) == []
        assert edit(season, *EDITS["rounds"]) == []


def test_a_comment_in_a_suite_and_rules_of_other_tracks_change_no_edition(season: Conducted) -> None:
    assert edit(season, "tiny.toml", 'name = "tiny"', '# Our own suite.\nname = "tiny"') == []
    assert edit(season, "tiny.toml", "[tracks.battle]\nmaps = 1", "[tracks.battle]\nmaps = 2") == []
    assert season.write(edition_numbers)["navigation"] == 1


def test_boards_name_a_model_whose_server_may_move(season: Conducted) -> None:
    edit(season, *EDITS["a model"])
    apply(season)
    play(season)

    with season.database.reading() as session:
        shown = _rendered(session, "navigation", PUBLIC, season.now, None)
    assert "<dt>model</dt><dd>tiny (2,000 requests and 1,000,000 tokens a seat)</dd>" in shown
    assert edit(season, SETTINGS_FILE, "http://host/v1", "http://other:81/v1") == []


def test_an_edition_that_cannot_be_played_here_waits_until_it_can(season: Conducted) -> None:
    season.active("owls")
    (navigation, *_) = edit(season, *EDITS["the sandbox"])
    assert "2 matches of the edition in force wait until then" in navigation.text
    assert "they belong to the sandbox process, and this is bubblewrap" in navigation.text
    assert season.take_matches(8) == []
    with pytest.raises(RefusalError, match=r"matches of navigation wait \(runner-3\), and cannot be played"):
        finalize(season)
    file, old, new = EDITS["the sandbox"]
    assert edit(season, file, new, old) == []
    assert play(season) == 2


@pytest.mark.parametrize("what", ["a model", "the sandbox"])
def test_a_conductor_that_has_to_be_started_again_is_named(season: Conducted, what: str) -> None:
    running = Conductor(season.season, season.database)
    running._sandbox = "process"

    def publish() -> None:
        season.write(lambda session: running._publish_nodes(session, LocalExecutor(1)))

    def failed() -> str | None:
        with season.database.reading() as session:
            return status(session, season.season, season.now).failed

    publish()
    rewrite(season, *EDITS[what])
    assert failed() is None, "it plays on under the old edition"
    done = run_command("season", "apply", season.season.folder, "--yes")
    said = "matches of navigation, battle wait until you start `wildscav season serve` again"
    assert said in " ".join(done.stdout.split())
    assert str(failed()).startswith(said)

    running.season, running._sandbox = season.season, season.season.settings.execution.sandbox or "process"
    publish()
    assert failed() is None


def test_a_track_that_is_removed_goes_on_until_that_is_applied(season: Conducted) -> None:
    season.active("foxes")
    (change,) = edit(season, SETTINGS_FILE, navigation(season), "")

    assert change.text == (
        "navigation is removed: its boards stay as they are; 2 matches of the edition in force are given up"
    )
    assert len(season.take_matches(1)) == 1
    apply(season)
    season.refresh()
    assert WAITING not in counts(season), "nothing waits for ever"
    assert ranked(season) == [("foxes", 2), ("owls", 2)]


def navigation(season: Conducted) -> str:
    """The settings of navigation."""
    text = (season.season.folder / SETTINGS_FILE).read_text()
    return text[text.index("[tracks.navigation]") : text.index("[tracks.battle]")]


def test_a_track_that_is_put_back_goes_on_where_it_was(season: Conducted) -> None:
    season.active("foxes")
    edit(season, *EDITS["the suite"])
    apply(season)
    track, number = navigation(season), season.write(edition_numbers)["navigation"]
    edit(season, SETTINGS_FILE, track, "")
    apply(season)
    assert season.take_matches(8) == []

    assert edit(season, SETTINGS_FILE, "[tracks.battle]", track + "[tracks.battle]") == []

    assert season.write(edition_numbers)["navigation"] == number
    assert play(season) == 6, "two of each entry"
    assert ranked(season) == [("foxes", 2), ("owls", 2)]


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
