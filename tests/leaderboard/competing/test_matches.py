"""Teams, checks, matches with their logs and replays, and the board, by command."""

from pathlib import Path

import pytest
from tests.leaderboard.agents import write_agent
from tests.leaderboard.competing.season_site import Competitor

from wildscav.errors import UserError
from wildscav_engine.record import read_record
from wildscav_evaluator.check.season import SeasonRules
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_leaderboard.accounts.models import ORGANIZER
from wildscav_leaderboard.accounts.service import find_account


def test_a_team_is_made_joined_and_left(competitor: Competitor) -> None:
    competitor.logged_in("uma")
    made = competitor.document("team", "create", "urchins", "--title", "The Urchins")
    assert made["team"]["members"] == ["uma"]

    competitor.logged_in("vic")
    assert "uma, vic" in competitor.run("team", "join", made["key"]).stdout
    again = competitor.refused("team", "join", made["key"])
    assert again == "wildscav: you are a member of the team urchins: leave it first\n"

    new = competitor.run("team", "key").stdout.strip()
    assert competitor.document("team", "leave") == {"left": "urchins"}
    competitor.refused("team", "show")
    assert "The Urchins" in competitor.run("team", "show", "urchins").stdout

    old = competitor.refused("team", "join", made["key"])
    assert old == "wildscav: this key is of no team: ask a teammate for a new one\n"
    competitor.told("team", "join", new)


def test_names_that_are_no_names_are_refused(competitor: Competitor) -> None:
    competitor.logged_in("wanda")
    for name in ("A/B", "../accounts", "x" * 41):
        assert "is not allowed" in competitor.refused("team", "create", name)
        competitor.refused("team", "show", name)


def test_a_check_has_the_seasons_sandbox_limits_and_seats(competitor: Competitor, tmp_path: Path) -> None:
    season = competitor.site.season
    walker = load_submission(write_agent(tmp_path, "walker", tracks='["navigation", "battle", "royale"]'))

    rules = SeasonRules.of(competitor.site.url)
    trials = rules.trials(walker, "quick")

    assert rules.validation.sandbox == season.settings.execution.sandbox
    assert {track: trial.limits for track, trial in trials.items()} == {
        track: season.limits(track) for track in ("navigation", "battle")
    }
    assert trials["battle"].spec.seats == ("submission", "fighter")


def test_a_season_without_the_submissions_tracks_is_refused(competitor: Competitor, tmp_path: Path) -> None:
    walker = load_submission(write_agent(tmp_path, "walker", tracks='["royale"]'))
    with pytest.raises(UserError, match="the season has only navigation, "):
        SeasonRules.of(competitor.site.url).trials(walker, "quick")


@pytest.mark.parametrize(
    ("url", "says"),
    [
        ("season.example.org", "must be an address such as https://season.example.org"),
        ("http://127.0.0.1:9", "cannot ask the season http://127.0.0.1:9: .*refused"),
        ("{site}/nowhere", "HTTP Error 404"),
        ("http://[", "cannot ask the season"),
    ],
)
def test_what_is_no_season_is_said_to_be_none(competitor: Competitor, url: str, says: str) -> None:
    with pytest.raises(UserError, match=says):
        SeasonRules.of(url.replace("{site}", competitor.site.url))


def test_the_matches_of_a_submission_are_listed_with_their_outcomes(competitor: Competitor) -> None:
    competitor.logged_in("ada", "ants")
    number, other = competitor.submitted("one"), competitor.submitted("two")
    first = competitor.site.played(number, 0)
    second = competitor.site.played(other, 2)

    listed = competitor.document("team", "matches", number)["matches"]
    assert [one["id"] for one in listed] == [first]
    newest = competitor.document("team", "matches", "--limit", 1)["matches"]
    assert [one["id"] for one in newest] == [second]
    table = competitor.run("team", "matches", number).stdout
    assert "Ants, fighter" in table
    assert "supplies 0, kills 0, deaths 0" in table
    assert "no winner: a tie" in table
    shown = competitor.run("team", "matches", "--match", first).stdout
    assert "no winner: a tie" in shown
    assert "12.5 ms" in shown
    assert f"wildscav replay {first}" in shown


def test_logs_are_for_the_own_team_and_control_no_terminal(competitor: Competitor) -> None:
    competitor.logged_in("bob", "bats")
    number = competitor.submitted("one")
    match = competitor.site.played(number, 4, log="one\ttwo\n\x1b[2J[red]\u202e\n")

    log = competitor.told("team", "logs", "--match", match)
    assert log == "one     two\n\\x1b[2J[red]\\u202e\n"
    assert competitor.run("team", "logs", "--match", match, "--seat", 0).stdout == log
    logs = competitor.site.season.submission_folder(number) / "logs"
    logs.mkdir(parents=True)
    (logs / "late.log").touch()
    silent = {"submission": number, "log": "It printed nothing.\n"}
    assert competitor.document("team", "logs", number) == {"logs": [silent]}
    (logs / "battle.log").write_text("ready\n")
    assert competitor.run("team", "logs", number).stdout == "── battle ──\nready\n\n"

    competitor.logged_in("carol", "crows")
    for arguments in (("--match", match, "--seat", 0), ("--match", match), (number,)):
        assert "your team has no" in competitor.refused("team", "logs", *arguments)

    with competitor.site.database.writing() as session:
        account = find_account(session, "carol")
        assert account is not None
        account.role = ORGANIZER
    assert competitor.run("team", "logs", "--match", match).stdout == log


def test_a_match_is_replayed_by_its_number(competitor: Competitor) -> None:
    competitor.logged_in("dave", "ducks")
    match = competitor.site.played(competitor.submitted("one"), 6)

    competitor.told("replay", match, "--no-images")
    record, replay = (competitor.folder / f"match-{match}{suffix}" for suffix in (".wsr", ".rrd"))
    assert read_record(record).names[0].startswith("one")
    assert replay.read_bytes()[:3] == b"RRF"
    # What is there already is not downloaded again, and what is something else is not overwritten.
    record.chmod(0o444)
    assert "the record of match" not in competitor.run("replay", match, "--no-images").stdout
    record.unlink()
    record.write_bytes(b"my own")
    assert "is another file" in competitor.run("replay", match).stderr
    assert record.read_bytes() == b"my own"
    assert sorted(path.name for path in competitor.folder.iterdir() if path.name.startswith(".")) == []


def test_anyone_sees_the_boards(competitor: Competitor) -> None:
    of_site = ("leaderboard", "--season", competitor.site.url)
    assert "There are no results in The trial season yet." in competitor.told(*of_site)
    wrong = competitor.refused(*of_site, "--track", "batle")
    assert "has no track batle (did you mean 'battle'?)" in wrong
    nowhere = competitor.run("leaderboard", "--season", "latest").stderr
    assert nowhere == "wildscav: you are logged in to no season: `wildscav login URL`\n"
