"""Teams by command."""

import json

from tests.leaderboard.competing.season_site import Competitor


def test_a_team_is_made_joined_and_left(competitor: Competitor) -> None:
    competitor.logged_in("ada")
    made = json.loads(competitor.run("team", "create", "ants", "--title", "The Ants", "--json").stdout)
    assert made["team"]["members"] == ["ada"]

    competitor.logged_in("bob")
    assert "ada, bob" in competitor.run("team", "join", made["key"]).stdout
    again = competitor.run("team", "join", made["key"])
    assert again.stderr == "wildscav: you are a member of the team ants: leave it first\n"

    new = competitor.run("team", "key").stdout.strip()
    assert json.loads(competitor.run("team", "leave", "--json").stdout) == {"left": "ants"}
    assert competitor.run("team", "show").returncode == 1
    assert "The Ants" in competitor.run("team", "show", "ants").stdout

    old = competitor.run("team", "join", made["key"])
    assert old.stderr == "wildscav: this key is of no team: ask a teammate for a new one\n"
    assert competitor.run("team", "join", new).returncode == 0


def test_names_that_are_no_names_are_refused(competitor: Competitor) -> None:
    competitor.logged_in("carol")
    for name in ("A/B", "../accounts", "x" * 41):
        assert "is not allowed" in competitor.run("team", "create", name).stderr
        assert competitor.run("team", "show", name).returncode == 1
