"""What `wildscav check --season` takes from a season."""

from pathlib import Path

import pytest
from tests.leaderboard.agents import write_agent
from tests.leaderboard.competing.season_site import Competitor

from wildscav.errors import UserError
from wildscav_evaluator.check.season import SeasonRules
from wildscav_evaluator.submissions.submission import load_submission


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
