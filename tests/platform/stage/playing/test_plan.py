"""Which matches can be asked for."""

from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav_engine.specs.rules import NAMED
from wildscav_server.hosting.opponents import numbered
from wildscav_stage.playing.plan import make_plan

HOMING = Path(__file__).parents[4] / "submissions" / "homing"
READER = HOMING.parents[1] / "benchmarks" / "strength" / "reader"


@pytest.mark.parametrize(
    ("track", "opponents", "people", "seats", "names"),
    [
        ("navigation", None, 1, "submission", "person"),
        (  # those of the same kind have numbers
            *("battle", ["fighter-easy", "gatherer", "gatherer"], 1),
            *("submission fighter-easy gatherer gatherer", "person, fighter-easy, gatherer 1, gatherer 2"),
        ),
        (  # each track has opponents that suit it, fewer with more people
            *("battle", None, 3, "submission submission submission fighter-easy"),
            "person 1, person 2, person 3, fighter-easy",
        ),
        ("battle", ["fighter"], 2, "submission submission fighter", "person 1, person 2, fighter"),
        (  # a submission has a seat with its sensors, before robots, which the host may change
            *("navigation", ["seeker", str(HOMING)], 1, "submission submission seeker"),
            "person, homing, seeker",
        ),
    ],
)
def test_people_have_the_first_seats_and_opponents_the_others(
    track: str, opponents: list[str] | None, people: int, seats: str, names: str
) -> None:
    plan = make_plan(track, None, 4, opponents, 30.0, people)
    assert plan.spec.seats == tuple(seats.split())
    assert plan.names == tuple(names.split(", "))
    assert (plan.spec.frames_per_action, plan.spec.time_limit) == (1, 30.0)  # fifty steps a second
    assert plan.may_pause == (people == 1 and "homing" not in names)  # which need their time


def test_each_track_has_opponents_that_suit_it() -> None:
    assert len(make_plan("battle", None, 0, None, None).spec.seats) == 4
    assert make_plan("battle", None, 0, None, None, people=6).spec.seats == ("submission",) * 6
    assert make_plan("royale", None, 0, None, None).spec.time_limit == 300.0


def test_the_next_match_has_the_next_seed_on_the_same_map() -> None:
    plan = make_plan("navigation", 101, 2**64 - 1, None, None)
    assert plan.played(0) == plan.spec
    assert plan.played(1).seed == 0
    assert plan.played(1).map == plan.spec.map


def test_submissions_come_before_robots_which_the_host_may_change() -> None:
    plan = make_plan("navigation", 101, 0, ["seeker", str(HOMING)], None)
    assert plan.opponents[0].folder == HOMING
    changed = plan.arranged(["walker", "walker"], new_map=True)
    assert changed.names == ("person", "homing", "walker 1", "walker 2")
    assert changed.spec.seats == ("submission", "submission", "walker", "walker")
    assert changed.submissions == plan.submissions
    assert changed.spec.map.config == plan.spec.map.config  # another map of the same kind
    assert changed.spec.map.seed == plan.spec.map.seed + 1
    assert plan.arranged(["seeker"], new_map=False) == plan


def test_an_arrangement_that_is_no_match_is_refused() -> None:
    with pytest.raises(UserError, match="such a match is not possible: seats"):
        make_plan("battle", None, 3, (), None).arranged(["fighter"] * 10_000, new_map=False)


def test_a_robot_plays_for_each_person_who_is_not_here() -> None:
    plan = make_plan("navigation", None, 0, ["walker"], None, people=3)
    assert plan.played(0, absent=[1]).seats == ("submission", "seeker-easy", "submission", "walker")


@pytest.mark.parametrize(
    ("names", "numbered_names"),
    [
        (["a", "b"], ("a", "b")),
        (["a", "b", "a"], ("a 1", "b", "a 2")),
        (["a", "a 1", "a"], ("a 2", "a 1", "a 3")),  # somebody has that name already
    ],
)
def test_no_two_seats_have_the_same_name(names: list[str], numbered_names: tuple[str, ...]) -> None:
    assert numbered(names) == numbered_names


def test_people_may_play_by_fair_rules() -> None:
    plan = make_plan("battle", None, 0, None, None, rules="fair")
    assert plan.spec.rules == NAMED["fair"]
    with pytest.raises(UserError, match="no rules are called 'unfair'; allowed are original, fair"):
        make_plan("battle", None, 0, None, None, rules="unfair")


@pytest.mark.parametrize(
    ("track", "map_id", "opponents", "message"),
    [
        ("chess", None, None, "--track is 'chess'; the tracks are navigation, "),
        ("battle", 1000, None, "id is 1000; maps have the ids 1 to 999"),
        ("battle", None, ["figher"], "neither a robot .* nor a folder .*did you mean 'fighter'"),
        ("battle", None, [str(HOMING.parent)], "cannot read .*submission.toml"),
        ("navigation", None, [str(HOMING.parent / "commando")], "commando does not play navigation"),
        ("navigation", None, [str(READER)], "interface: is 'words'; here, agents must play by numbers"),
    ],
)
def test_what_is_not_possible_is_said(
    track: str, map_id: int | None, opponents: list[str] | None, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        make_plan(track, map_id, 0, opponents, None)
