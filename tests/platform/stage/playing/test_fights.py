"""The figures of the fights in the table at the end of a match."""

import numpy as np
from tests.platform.stage.playing.tables import MEADOW, small_plan

from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_stage.playing.fights import Fights


def face_to_face() -> Match:
    """A battle of two who look at each other, 8 m apart."""
    spec = small_plan("battle", 60.0, people=2).spec
    lawn = MapSpec(config=MEADOW.model_copy(update={"houses": 0}), seed=5)
    match = Match(spec.model_copy(update={"map": lawn, "starts": ((0.0, 0.0, -4.0), (0.0, 0.0, 4.0))}))
    agents = match.state.agents
    agents.yaw[0], agents.pitch[0], agents.invincible_left[0] = (0.0, 180.0), 0.0, 0
    return match


def figures(fights: Fights, seat: int) -> dict[str, int | None]:
    return {column["title"]: fights.figure(seat, column["title"]) for column in fights.columns([])}


def test_a_hit_that_kills_counts_the_health_that_was_left() -> None:
    match = face_to_face()
    fights, actions = Fights(match), np.zeros((2, len(Field)), np.float32)
    match.state.agents.health[0, 1], fights._health[1] = 50, 50
    actions[0, Field.SHOOT] = 1.0
    for _ in range(31):  # three shots of 20 hp, one every ten frames, and one after the death
        match.step(actions)
        fights.note()
        fights.note()
    own, other = figures(fights, 0), figures(fights, 1)
    assert own == {"kills": 1, "deaths": 0, "dealt": 50, "taken": 0, "accuracy": 75}
    assert other == {"kills": 0, "deaths": 1, "dealt": 0, "taken": 50, "accuracy": None}


def test_what_the_track_shows_already_is_not_shown_twice_and_nothing_where_nobody_shoots() -> None:
    shown = Fights(face_to_face()).columns([{"title": "kills", "unit": ""}])
    assert [column["title"] for column in shown] == ["deaths", "dealt", "taken", "accuracy"]
    assert Fights(Match(small_plan().spec)).columns([]) == []
