"""Who takes part in a season, and who leaves: by a newer submission, by its team, or by the organizers."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import select
from tests.leaderboard.conductor.conducted import Conducted, conducting
from tests.leaderboard.seasons_made import changed, make_season

from wildscav_leaderboard.matches.models import Match, MatchSeat
from wildscav_leaderboard.organizing import acts
from wildscav_leaderboard.seasons.acts import Act
from wildscav_leaderboard.seasons.refusals import NotFoundError, RefusalError


@pytest.fixture
def season(tmp_path: Path) -> Iterator[Conducted]:
    """A season with two teams, of which this process is the conductor."""
    with conducting(make_season(tmp_path / "season")) as conducted:
        yield conducted


def test_matches_of_whoever_left_are_given_up(season: Conducted) -> None:
    number = season.active()
    ((attempt, match),) = season.take_matches(1)
    season.act(acts.disqualify_submission, number, reason="cheats")
    assert season.match(2).detail == f"withdrawn: submission {number} no longer takes part"
    assert season.broke(attempt.id)
    assert season.match(match.id).state == "waiting"
    assert season.take_matches(5) == []
    assert season.match(match.id).detail == "withdrawn: a submission of it no longer takes part"


def test_a_disqualified_team_takes_part_in_nothing(season: Conducted) -> None:
    active, building, waiting = season.active(), season.hand_in(), season.hand_in()
    attempt = season.taken()
    season.act(acts.disqualify_team, "foxes", reason="cheats")
    assert season.built(attempt.id) is None
    assert season.take() is None
    seen = [season.submission(number) for number in (active, building, waiting)]
    assert [one.state for one in seen] == ["disabled", "cancelled", "cancelled"]
    assert {one.reason for one in seen} == {"the team is disqualified: cheats"}


def test_a_newer_submission_replaces_the_oldest_one_and_an_older_one_nobody(season: Conducted) -> None:
    oldest = season.hand_in()
    attempt = season.taken()
    newer = [season.active(), season.active()]
    season.passed(attempt)
    one = season.submission(oldest)
    assert (one.state, one.reason) == ("disabled", "newer submissions of the team take part already")
    assert [season.submission(number).state for number in newer] == ["active", "active"]
    season.wait(24 * 3600.0)  # until the team may submit again
    season.take_over()
    newest = season.active()
    one = season.submission(newer[0])
    assert (one.state, one.reason) == ("disabled", f"replaced by submission {newest}")
    assert season.match(1).state == "void"
    with season.database.reading() as session:
        assert session.scalars(select(Match).filter_by(group_id=oldest)).all() == []


def test_whoever_was_disqualified_by_mistake_goes_on_where_it_was(season: Conducted) -> None:
    number = season.active()
    ((attempt, played), *_) = season.take_matches(1)
    assert season.played(attempt, 5.0)

    def act(one: Act, *what: object) -> None:
        season.act(one, *what, reason="a mistake")

    for take_off, bring_back, what in (
        (acts.disqualify_submission, acts.requalify_submission, number),
        (acts.disqualify_team, acts.requalify_team, "foxes"),
    ):
        act(take_off, what)
        assert (season.submission(number).state, season.match(2).state) == ("disabled", "void")
        if what == "foxes":
            with pytest.raises(RefusalError, match="`wildscav season requalify` takes that back"):
                act(acts.reactivate, number)
        act(bring_back, what)
        assert [season.match(one).state for one in (played.id, 2)] == ["finished", "waiting"]
        assert season.submission(number).state == "active"
        with pytest.raises(RefusalError, match="not disqualified"):
            act(bring_back, what)


def test_a_replaced_submission_takes_part_again_where_there_is_room(season: Conducted) -> None:
    oldest, second, third = (season.active() for _ in range(3))

    def reactivate() -> None:
        season.act(acts.reactivate, oldest, reason="asked for")

    with pytest.raises(RefusalError, match=f"and {second}, {third} do: disable one"):
        reactivate()
    season.act(acts.disqualify_submission, second, reason="it cheats")
    reactivate()
    assert season.submission(oldest).state == "active"
    assert season.match(1).state == "waiting"


BOTH = ("navigation", "battle")


def test_the_cap_counts_for_each_track_and_a_submission_leaves_only_the_track_where_it_is_too_many(
    season: Conducted,
) -> None:
    both, second = season.active(tracks=BOTH), season.active(tracks=("battle",))
    season.plan()
    third = season.active(tracks=("battle",))
    one = season.submission(both)
    assert (one.state, one.playing) == ("active", ["navigation"])
    assert [season.submission(number).playing for number in (second, third)] == [["battle"], ["battle"]]
    with season.database.reading() as session:
        seats = select(Match.track, Match.state).join(MatchSeat, MatchSeat.match_id == Match.id)
        found = session.execute(seats.where(MatchSeat.submission_id == both).distinct()).all()
    assert set(found) == {("navigation", "waiting"), ("battle", "void")}
    with pytest.raises(RefusalError, match=f"on battle, and {second}, {third} do: disable one"):
        season.decide("restore", both)
    season.decide("disable", second)
    season.decide("restore", both)
    assert season.submission(both).playing == list(BOTH)


def test_a_requalified_team_takes_part_as_before_it_was_disqualified(season: Conducted) -> None:
    numbers = [season.active(tracks=tracks) for tracks in (BOTH, ("battle",), ("battle",))]

    def requalified(active: int = 2) -> list[list[str]]:
        """Disqualify the team, and requalify it where so many may take part; return who plays where."""
        season.act(acts.disqualify_team, "foxes", reason="cheats")
        quotas = season.season.settings.quotas.model_copy(update={"active": active})
        season.season = changed(season.season, quotas=quotas)
        season.act(acts.requalify_team, "foxes", reason="it was another person")
        return [season.submission(number).playing for number in numbers]

    assert requalified() == [["navigation"], ["battle"], ["battle"]]
    assert requalified(active=1) == [["navigation"], [], ["battle"]]
    second = season.submission(numbers[1])
    assert (second.state, second.reason) == ("disabled", "newer submissions of the team take part already")
    season.decide("disable", numbers[2])
    season.decide("restore", numbers[1])
    assert season.submission(numbers[1]).playing == ["battle"]


def test_a_team_disables_and_restores_its_submissions_and_keeps_their_results(season: Conducted) -> None:
    number = season.active()
    ((attempt, played), *_) = season.take_matches(1)
    assert season.played(attempt, 5.0)
    with pytest.raises(RefusalError, match=f"`wildscav team submissions disable {number}` ends that"):
        season.decide("cancel", number)
    with pytest.raises(NotFoundError, match="your team has no submission"):
        season.decide("disable", number, team="owls")
    season.decide("disable", number)
    one = season.submission(number)
    assert (one.state, one.reason, season.match(2).state) == ("disabled", "disabled by its team", "void")
    season.decide("restore", number)
    assert season.submission(number).state == "active"
    assert [season.match(one).state for one in (played.id, 2)] == ["finished", "waiting"]
    season.act(acts.disqualify_submission, number, reason="cheats")
    with pytest.raises(RefusalError, match="only the organizers can take that back"):
        season.decide("restore", number)


def test_what_is_kept_is_not_replaced_unless_a_submission_names_it(season: Conducted) -> None:
    first, second = season.active(), season.active()
    season.decide("keep", first)
    third = season.active()
    assert [season.submission(one).state for one in (first, second, third)] == [
        "active",
        "disabled",
        "active",
    ]
    season.wait(24 * 3600)  # or the quota of the day would be used up
    season.decide("keep", third)
    with pytest.raises(
        RefusalError, match=f"{first}, {third} do, all of them kept: `wildscav team submissions rel"
    ):
        season.hand_in()
    season.decide("release", third)
    with pytest.raises(RefusalError, match="is active and not kept"):
        season.decide("release", third)
    with pytest.raises(RefusalError, match=f"no submission {second} that takes part on navigation"):
        season.hand_in(replaces=second)
    fourth = season.active(replaces=first)
    assert [season.submission(one).state for one in (first, third, fourth)] == [
        "disabled",
        "active",
        "active",
    ]
