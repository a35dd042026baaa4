"""What single seats have that others have not, and where they come back."""

import pytest
from pydantic import ValidationError
from tests.builders import act, place
from tests.builders import duel as made_duel

from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import Equipment, MatchSpec
from wildscav_engine.specs.rules import Rules


def duel(*equipment: Equipment | None, **spec: object) -> Match:
    return made_duel(equipment=equipment or None, **spec)


def test_a_seat_has_its_own_equipment_and_what_it_leaves_open_is_the_rules() -> None:
    match = duel(Equipment(health=40, spare_ammo=0), None, rules=Rules(clip_size=7))
    agents = match.state.agents
    assert agents.health[0].tolist() == [40, 100]
    assert agents.spare_ammo[0].tolist() == [0, 60]
    assert agents.clip[0].tolist() == [7, 7]
    assert match.spec.equipment_of(0) == (40, 7, 0, 20)


def test_shots_cost_what_the_shooter_has() -> None:
    match = duel(Equipment(shot_damage=35), Equipment(shot_damage=1))
    act(match, 1, seat_0={"shoot": 1}, seat_1={"shoot": 1})
    assert match.state.agents.health[0].tolist() == [99, 65]


def test_a_clip_is_filled_to_its_own_size_and_one_of_no_rounds_never_fires() -> None:
    match = duel(Equipment(clip_size=2, spare_ammo=3), Equipment(clip_size=0))
    act(match, 10, seat_0={"shoot": 1}, seat_1={"shoot": 1, "reload": 1})
    agents = match.state.agents
    assert agents.shots[0].tolist() == [2, 0]
    act(match, 1, seat_0={"reload": 1})
    act(match, 20)
    assert (agents.clip[0, 0], agents.spare_ammo[0, 0]) == (2, 1)


def test_who_comes_back_has_its_own_equipment_again() -> None:
    match = duel(Equipment(shot_damage=100), Equipment(health=60, clip_size=3, spare_ammo=4))
    act(match, 1, seat_0={"shoot": 1}, seat_1={"shoot": 1})
    act(match, 101)
    agents = match.state.agents
    assert (agents.health[0, 1], agents.clip[0, 1], agents.spare_ammo[0, 1]) == (60, 3, 4)


@pytest.mark.parametrize("is_taken", [False, True])
def test_the_dead_come_back_where_they_started_unless_somebody_stands_there(*, is_taken: bool) -> None:
    match = duel(Equipment(shot_damage=100), None, respawn_at="start", starts=(None, (9.0, 0.0, -9.0)))
    act(match, 1, seat_0={"shoot": 1})
    if is_taken:
        place(match, 0, (9, 0, -9))
    act(match, 101 if is_taken else 100)
    assert match.state.agents.health[0, 1] == 100
    x, y, z = match.state.agents.position[0, 1].tolist()
    if is_taken:
        assert (x - 9) ** 2 + (z + 9) ** 2 > 1.8**2
    else:
        assert (x, y, z) == pytest.approx((9, 0, -9), abs=0.01)


def test_a_match_goes_on_from_bytes_with_its_equipment() -> None:
    match = duel(Equipment(shot_damage=35), None)
    other = duel(Equipment(shot_damage=35), None)
    other.set_state(match.get_state())
    act(other, 1, seat_0={"shoot": 1})
    assert other.state.agents.health[0, 1] == 65


def test_equipment_is_given_for_every_seat() -> None:
    with pytest.raises(ValidationError, match="equipment has 1 entries for 2 seats"):
        MatchSpec(track="battle", seats=("submission",) * 2, equipment=(None,))
