"""Matches, their logs and their replays; the board."""

import json

from tests.leaderboard.competing.season_site import Competitor

from wildscav_engine.record import read_record
from wildscav_leaderboard.accounts.models import ORGANIZER
from wildscav_leaderboard.accounts.service import find_account


def test_the_matches_of_a_submission_are_listed_with_their_outcomes(competitor: Competitor) -> None:
    competitor.logged_in("ada", "ants")
    number, other = competitor.submitted("one"), competitor.submitted("two")
    first = competitor.site.played(number, 0)
    second = competitor.site.played(other, 2)

    listed = json.loads(competitor.run("team", "matches", number, "--json").stdout)["matches"]
    assert [one["id"] for one in listed] == [first]
    newest = json.loads(competitor.run("team", "matches", "--limit", 1, "--json").stdout)["matches"]
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

    done = competitor.run("team", "logs", "--match", match)
    assert done.stdout == "one     two\n\\x1b[2J[red]\\u202e\n"
    assert competitor.run("team", "logs", "--match", match, "--seat", 0).stdout == done.stdout
    logs = competitor.site.season.submission_folder(number) / "logs"
    logs.mkdir(parents=True)
    (logs / "late.log").touch()
    assert json.loads(competitor.run("team", "logs", number, "--json").stdout) == {
        "logs": [{"submission": number, "log": "It printed nothing.\n"}]
    }
    (logs / "battle.log").write_text("ready\n")
    assert competitor.run("team", "logs", number).stdout == "── battle ──\nready\n\n"

    competitor.logged_in("carol", "crows")
    for arguments in (("--match", match, "--seat", 0), ("--match", match), (number,)):
        refused = competitor.run("team", "logs", *arguments)
        assert refused.returncode == 1
        assert "your team has no" in refused.stderr

    with competitor.site.database.writing() as session:
        account = find_account(session, "carol")
        assert account is not None
        account.role = ORGANIZER
    assert competitor.run("team", "logs", "--match", match).stdout == done.stdout


def test_a_match_is_replayed_by_its_number(competitor: Competitor) -> None:
    competitor.logged_in("dave", "ducks")
    match = competitor.site.played(competitor.submitted("one"), 6)

    done = competitor.run("replay", match, "--no-images")

    assert done.returncode == 0, done.stderr
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
    none_yet = competitor.run("leaderboard", "--season", competitor.site.url)
    assert none_yet.returncode == 0, none_yet.stderr
    assert "There are no results in The trial season yet." in none_yet.stdout
    wrong = competitor.run("leaderboard", "--season", competitor.site.url, "--track", "batle")
    assert "has no track batle (did you mean 'battle'?)" in wrong.stderr
    assert competitor.run("leaderboard", "--season", "latest").stderr == (
        "wildscav: you are logged in to no season: `wildscav login URL`\n"
    )
