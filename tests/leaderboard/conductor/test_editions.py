"""The rules of a season are versions: an edit shows its effect, waits to be applied, and empties no board."""

from collections.abc import Iterator
from pathlib import Path
from shutil import make_archive

import pytest
from sqlalchemy import select
from tests.commands import run_command
from tests.leaderboard.agents import write_agent
from tests.leaderboard.conductor.conducted import Conducted, conducting
from tests.leaderboard.conductor.edited import (
    EDITS,
    apply,
    counts,
    edit,
    finalize,
    navigation,
    play,
    played_by_two,
    ranked,
    rewrite,
)
from tests.leaderboard.seasons_made import make_season

from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.matches.models import VOID, WAITING, Match
from wildscav_leaderboard.matches.service import NOT_IN_FORCE
from wildscav_leaderboard.organizing import finalizing
from wildscav_leaderboard.organizing.acts import ACTS
from wildscav_leaderboard.organizing.checking import check_season, entries_without_model
from wildscav_leaderboard.organizing.status import status
from wildscav_leaderboard.seasons.in_force import edition_numbers
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE
from wildscav_leaderboard.visibility import PUBLIC, audience_of
from wildscav_leaderboard.web.boards import _rendered


@pytest.fixture
def season(tmp_path: Path) -> Iterator[Conducted]:
    with played_by_two(tmp_path) as played:
        yield played


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


def test_a_server_tells_changes_of_the_rules_as_they_are_written_now(season: Conducted) -> None:
    serving = season.season

    def changes() -> list[str]:
        with season.database.reading() as session:
            return status(session, serving, season.now).changes

    rewrite(season, *EDITS["the suite"])
    assert "navigation" in "".join(changes())
    apply(season)
    assert changes() == []
    (serving.folder / SETTINGS_FILE).write_text("name = 7")
    assert SETTINGS_FILE in "".join(changes())


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
