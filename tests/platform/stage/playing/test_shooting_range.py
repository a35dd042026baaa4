"""The shooting range: where its targets are, how they move, and that they come back."""

import asyncio
from pathlib import Path

import numpy as np
import pytest
from tests.platform.stage.playing.pages import page
from tests.platform.stage.playing.tables import table

from wildscav.errors import UserError
from wildscav_engine.record import read_record, resimulate, verify_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.systems.visibility import Eye, sees_body
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_stage.playing.plan import make_range
from wildscav_stage.playing.shooting_range import TARGETS, WAYS, Movement

SECONDS = 3.0


def test_the_person_sees_every_target_at_its_distance() -> None:
    plan = make_range(3, None)
    match = Match(plan.spec)
    own, *others = match.state.agents.position[0]
    eye = Eye(own[0], own[1] + EYE_HEIGHT, own[2], 0.0, 0.0, plan.spec.rules.view_angle)
    for target, place in zip(TARGETS, others, strict=True):
        assert sees_body(match.game_map.world, eye, *place), target
        assert place[2] - own[2] == pytest.approx(target.distance, abs=0.01)
        assert str(round(target.distance)) in target.name
    assert plan.may_pause
    assert plan.spec.time_limit == 180.0
    with pytest.raises(UserError, match="has targets"):
        plan.arranged(["fighter"], new_map=False)


def test_targets_move_as_they_are_called_and_the_record_holds(tmp_path: Path) -> None:
    async def play() -> Path:
        async with table(make_range(3, SECONDS), tmp_path) as link, page(link) as person:
            assert (await person.until("table"))["is_range"]
            await person.send(kind="start")
            return Path(str((await person.until("over"))["record"]))

    record = read_record(asyncio.run(play()))
    assert verify_record(record).holds
    places = np.array([match.state.agents.position[0, 1:, 0].copy() for match in resimulate(record)])
    for target, across in zip(TARGETS, places.T, strict=True):
        steps = np.diff(across)[np.abs(np.diff(across)) > 1e-3]
        turns = np.count_nonzero(np.diff(np.sign(steps)))
        moves = target.movement != Movement.STANDS
        assert (np.ptp(across) > 1.5) == moves, target
        assert np.abs(across - target.aside).max() < (WAYS[target.movement] + 0.5 if moves else 0.01), target
        assert (turns > 1) == (target.movement == Movement.STRAFES), target
    assert record.result.seats[0].deaths == 0


def test_a_target_that_was_shot_is_back_after_a_moment() -> None:
    match = Match(make_range(3, None).spec)
    agents = match.state.agents
    agents.damage[0, 1] = 1000
    match.step()
    assert agents.health[0, 1] == 0
    for _ in range(80):
        match.step()
    assert agents.health[0, 1] == 100
    assert agents.position[0, 1, 0] == pytest.approx(TARGETS[0].aside, abs=0.01)
    assert agents.invincible_left[0, 1] == 0


def test_rules_that_do_not_exist_are_refused() -> None:
    assert make_range(0, 20.0, "fair").spec.rules.recoil > 0
    with pytest.raises(UserError, match="--rules is 'unfair'; the rules are original, fair"):
        make_range(0, 20.0, "unfair")
