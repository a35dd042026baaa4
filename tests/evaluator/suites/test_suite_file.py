"""An organizer's own suite: all that maps and matches can be, drawn from a file."""

from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav_engine.maps.catalogue import map_spec
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, Limits
from wildscav_evaluator.suites import suite_file
from wildscav_evaluator.suites.suite import EVALUATION_MAPS, SUITES
from wildscav_evaluator.suites.suite_file import find_suite, read_suite

SPRING = """
name = "spring"
title = "the spring season"

[map]
size = 80
houses = 1
storeys = [1, 2]

[map.choose]
density = ["low", "high"]
relief = [0.5, 1.0]

[tracks.navigation]
maps = 6
episodes = 3
match = { time_limit = 30 }

[tracks.gathering]
maps = [14, 101]

[tracks.gathering.match.supplies]
waves = [{ center = [0, 0], radius = 10 }]

[tracks.gathering.choose]
"time_limit" = [20, 40]
"supplies.waves.0.radius" = [10, 30, 50]
"supplies.spacing" = [5, 10]

[tracks.battle]
maps = 20
match = { seats = ["submission", "fighter-easy", "gatherer"], rules = { shot_damage = 5 } }
"""


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    def write(content: str) -> Path:
        path = tmp_path / "own.toml"
        path.write_text(content)
        return path

    return write


def test_maps_and_matches_are_drawn_from_what_the_file_says(write: Callable[[str], Path]) -> None:
    suite = read_suite(write(SPRING))

    navigation = suite.matches("navigation", 0)
    maps = {spec.map for spec in navigation}
    assert len(navigation) == 18
    assert len(maps) == 6
    assert {(one.config.size, one.config.houses, one.config.storeys) for one in maps} == {(80, 1, (1, 2))}
    assert {one.config.density for one in maps} == {"low", "high"}
    assert {one.config.relief for one in maps} == {0.5, 1.0}
    assert all(one.seed >= EVALUATION_MAPS for one in maps)
    assert {spec.time_limit for spec in navigation} == {30.0}
    assert len({spec.seed for spec in navigation}) == 18


def test_known_maps_are_played_by_their_numbers(write: Callable[[str], Path]) -> None:
    suite = read_suite(write(SPRING))

    assert [spec.map for spec in suite.matches("gathering", 3)] == [map_spec(14), map_spec(101)]


def test_fields_deep_inside_are_drawn_by_their_path(write: Callable[[str], Path]) -> None:
    suite = read_suite(write(SPRING))
    drawn = [spec for seed in range(30) for spec in suite.matches("gathering", seed)]

    assert {spec.time_limit for spec in drawn} == {20.0, 40.0}
    assert {spec.supplies.waves[0].radius for spec in drawn if spec.supplies} == {10.0, 30.0, 50.0}
    assert {spec.supplies.spacing for spec in drawn if spec.supplies} == {5.0, 10.0}


def test_seats_are_dealt_anew_for_each_match_unless_the_file_says_no(write: Callable[[str], Path]) -> None:
    battles = read_suite(write(SPRING)).matches("battle", 0)

    assert {spec.seats.index(SUBMISSION) for spec in battles} == {0, 1, 2}
    assert {tuple(sorted(spec.seats)) for spec in battles} == {("fighter-easy", "gatherer", SUBMISSION)}
    assert {spec.rules.shot_damage for spec in battles} == {5}

    fixed = SPRING.replace("[tracks.battle]", "[tracks.battle]\nshuffle = false")
    assert {spec.seats.index(SUBMISSION) for spec in read_suite(write(fixed)).matches("battle", 0)} == {0}


def test_a_suite_is_a_function_of_its_file_and_seed(write: Callable[[str], Path]) -> None:
    suite, same = read_suite(write(SPRING)), read_suite(write(SPRING))
    edited = read_suite(write(SPRING.replace("houses = 1", "houses = 2")))

    assert suite.matches("battle", 1) == same.matches("battle", 1) != same.matches("battle", 2)
    assert suite.label == same.label != edited.label
    assert suite.label.startswith("spring@")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('name = "spring"', 'name = "quick"', "name: 'quick' is a suite of Wildscav: choose another name"),
        ('name = "spring"', "", "name: Field required"),
        ("size = 80", "size = 81", "map: size: Input should be a multiple of 2, not 81"),
        ("size = 80", "sise = 80", "map: sise: Extra inputs are not permitted; its fields are size, "),
        (
            "relief = [0.5, 1.0]",
            "relief = [0.5, 9.0]",
            "map: relief: Input should be less than or equal to 2",
        ),
        ("relief = [0.5, 1.0]", "relief = []", "map.choose.relief: List should have at least 1 item"),
        ("[tracks.battle]", "[tracks.fishing]", "there is no track 'fishing'; the tracks are navigation,"),
        (
            "maps = 6",
            "maps = 0",
            "tracks.navigation.maps.count: Input should be greater than or equal to 1, not 0",
        ),
        ("maps = 6", "maps = []", "tracks.navigation.maps.numbers: List should have at least 1 item"),
        ("maps = [14, 101]", "maps = [14, 1000]", "id is 1000; maps have the ids 1 to 999"),
        ("time_limit = 30", "seed = 3", "tracks.navigation.match: seed is set by the suite itself"),
        (
            "time_limit = 30",
            "time_limit = -1",
            "tracks.navigation: time_limit: Input should be greater than 0",
        ),
        ("time_limit = 30", "supplies = {}", "supplies is given, but navigation has no supplies"),
        ('"supplies.waves.0', '"zone.phases.0', "no 'zone.phases.0.radius' among the fields"),
        ('"supplies.waves.0', '"supplies.waves.7', "no 'supplies.waves.7.radius' among the fields"),
        ('"fighter-easy"', '"knight"', "seat 1 is filled by 'knight'; allowed are submission"),
        ('"submission", ', "", "tracks.battle: no seat is filled by 'submission'"),
        ("[map]", "[map", "is not valid TOML"),
        (  # each is valid beside the first of the other
            "match = { time_limit = 30 }",
            'choose = { clock = ["running", "bank"], "thinking.pace" = [1.0, 2.0] }',
            "tracks.navigation: thinking.pace is given, but the clock bank does not use it",
        ),
    ],
)
def test_what_is_wrong_with_a_file_is_one_line(
    write: Callable[[str], Path], old: str, new: str, says: str
) -> None:
    path = write(SPRING.replace(old, new, 1))

    with pytest.raises(UserError) as refused:
        read_suite(path)

    assert says in str(refused.value)
    assert str(refused.value).startswith(str(path))
    assert "\n" not in str(refused.value)
    assert refused.value.exit_code == 2


def test_of_too_many_combinations_a_wrong_one_is_refused_when_it_is_drawn(
    write: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(suite_file, "MAX_COMBINATIONS", 3)
    choices = 'choose = { clock = ["running", "bank"], "thinking.pace" = [1.0, 2.0] }'
    suite = read_suite(write(SPRING.replace("match = { time_limit = 30 }", choices)))

    with pytest.raises(UserError, match="draws what is not valid: ") as refused:
        suite.matches("navigation", 0)
    assert refused.value.exit_code == 2


def test_suites_are_found_by_name_or_file(write: Callable[[str], Path]) -> None:
    assert find_suite("quick") is SUITES["quick"]
    assert find_suite(str(write(SPRING))).name == "spring"
    with pytest.raises(
        UserError,
        match="no suite 'slow'; the suites are quick, official, wild, fair, reading, or name a file",
    ):
        find_suite("slow")
    with pytest.raises(UserError, match=r"nowhere\.toml: No such file"):
        find_suite("nowhere.toml")


def test_a_track_may_have_limits_of_its_own(write: Callable[[str], Path]) -> None:
    tighter = SPRING.replace("maps = 6", 'maps = 6\nlimits = { memory = "512MiB", cpus = 0.5 }')

    suite = read_suite(write(tighter))

    assert suite.limits["navigation"] == Limits(memory=512 << 20, cpus=0.5)  # type: ignore[arg-type]
    assert suite.limits["battle"] == DEFAULT_LIMITS
    with pytest.raises(UserError, match=r"limits\.memory"):
        read_suite(write(tighter.replace("512MiB", "1MiB")))


def test_a_longest_time_must_allow_the_match_with_the_most_steps(write: Callable[[str], Path]) -> None:
    chosen = """
        name = "spring"
        [tracks.navigation]
        maps = 2
        choose = { time_limit = [10, 30, 20], frames_per_action = [5, 1] }
        limits = { wall_clock = LONGEST }
    """

    assert read_suite(write(chosen.replace("LONGEST", "150"))).limits["navigation"].wall_clock == 150
    with pytest.raises(UserError, match=r"navigation\.limits\.wall_clock: .* 1,500 steps alone are 150 s$"):
        read_suite(write(chosen.replace("LONGEST", "149")))


def test_a_suite_may_wait_for_its_agents_and_is_compared_with_no_other(write: Callable[[str], Path]) -> None:
    waiting = read_suite(write(SPRING.replace("time_limit = 30", 'time_limit = 30, clock = "paused"')))
    usual = read_suite(write(SPRING))
    assert {spec.clock for spec in waiting.matches("navigation", 3)} == {"paused"}
    assert waiting.fingerprints["navigation"] != usual.fingerprints["navigation"]
    assert waiting.fingerprints["battle"] == usual.fingerprints["battle"]
