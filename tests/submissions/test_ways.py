"""Navigator and mapper: how they find their way, in real matches."""

import importlib.util
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from wildscav import MatchInfo
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_engine.specs.map_spec import MapConfig, MapSpec, Placement
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.tracks.navigation import spl_of
from wildscav_evaluator.suites.suite import suite
from wildscav_server.time_limits import Clock
from wildscav_training.opponents import SubmissionOpponent, submission
from wildscav_training.opponents.seat_messages import seat_info

SUBMISSIONS = Path(__file__).parents[2] / "submissions"
BARE = MapConfig(size=100, houses=0, relief=0, water=0, vegetation=0)
START, TARGET = (0.0, 0.0, -30.0), (0.0, 0.0, 30.0)


def wall(x: float, z: float, length: float, orientation: float) -> Placement:
    return Placement(kind="block", location=(x, z), area=(length, 1.0), orientation=orientation, height=2.5)


# Three walls, open towards the start: who walks straight to the target ends up inside.
DEAD_END = (wall(0.0, 10.0, 25.0, 0.0), wall(-12.0, 4.0, 12.0, 90.0), wall(12.0, 4.0, 12.0, 90.0))


class Played(NamedTuple):
    """A match of one agent."""

    agent: Any
    batch: Batch
    positions: NDArray[np.float64]  # (T, 3) m
    actions: NDArray[np.float32]  # (T, FIELDS)
    checkpoints: list[Any]  # (T) where the navigator returns to, or None


def play(name: str, spec: MatchSpec) -> Played:
    batch, opponent = Batch([spec]), submission(name)
    match, seat = np.zeros(1, np.int64), np.zeros(1, np.int64)
    opponent.begin(batch, match, seat)
    rows = np.zeros((1, len(spec.seats), FIELDS), np.float32)
    positions, actions, checkpoints = [], [], []
    while not batch.state.matches.over[0]:
        rows[0, 0] = opponent.act(batch, match, seat)[0]
        positions.append(batch.state.agents.position[0, 0].copy())
        actions.append(rows[0, 0].copy())
        checkpoints.append(next(iter(getattr(agent_of(opponent), "way_back", [])), None))
        batch.step(rows)
    return Played(agent_of(opponent), batch, np.array(positions), np.array(actions), checkpoints)


def agent_of(opponent: SubmissionOpponent) -> Any:
    return opponent._agents[0, 0]


def course(*placements: Placement, seats: int = 1, time_limit: float = 60.0) -> MatchSpec:
    """A match from south to north; the other seats stand in the way, and no depth map shows them."""
    starts = (START, *((0.8 * (seat - seats / 2.0), 0.0, -15.0) for seat in range(1, seats)))
    game_map = MapSpec(config=BARE.model_copy(update={"placements": placements}), seed=1)
    return MatchSpec(
        track="navigation",
        map=game_map,
        seats=(SUBMISSION,) * seats,
        starts=starts,
        target=TARGET,
        time_limit=time_limit,
    )


def is_reached(played: Played) -> bool:
    return bool(played.batch.state.agents.reached[0, 0])


def spl(played: Played) -> float:
    return spl_of(MatchInBatch(played.batch, 0), [0])


@pytest.mark.parametrize("name", ["navigator", "mapper"])
def test_they_walk_straight_over_open_ground(name: str) -> None:
    played = play(name, course())

    assert is_reached(played)
    assert spl(played) > 0.98
    assert not played.actions[:, Field.JUMP].any()


@pytest.mark.parametrize("name", ["navigator", "mapper"])
def test_they_jump_where_what_blocks_them_is_not_to_be_seen_and_then_go_around_it(name: str) -> None:
    played = play(name, course(seats=4))

    jumps = played.positions[played.actions[:, Field.JUMP] == 1.0]
    assert len(jumps) > 0
    assert np.hypot(*(jumps[0] - (0.0, 0.0, -15.0))[[0, 2]]) < 3.0
    assert is_reached(played)


def test_the_navigator_returns_to_a_checkpoint_when_it_is_stuck_and_gets_out_of_a_dead_end() -> None:
    played = play("navigator", course(*DEAD_END))

    returning = [step for step, checkpoint in enumerate(played.checkpoints) if checkpoint is not None]
    assert returning
    first = returning[0]
    checkpoint = np.array(played.checkpoints[first])
    before, after = played.positions[:first], played.positions[first : first + 25]
    assert np.hypot(*(before - checkpoint)[:, [0, 2]].T).min() < 1.0  # it was there
    assert np.hypot(*(after - checkpoint)[:, [0, 2]].T).min() < 2.0  # and got back
    assert is_reached(played)


def test_the_mapper_plans_its_way_out_of_a_dead_end() -> None:
    played = play("mapper", course(*DEAD_END))

    assert is_reached(played)
    assert spl(played) > 0.7


@pytest.mark.slow
def test_the_mapper_finds_targets_in_wild_country_that_homing_does_not() -> None:
    specs = suite("navigation", "wild", 0)

    assert all(is_reached(play("mapper", specs[number])) for number in (24, 28))


@pytest.fixture(scope="module")
def columns_module() -> ModuleType:
    found = importlib.util.spec_from_file_location("mapper_columns", SUBMISSIONS / "mapper" / "columns.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def match_info() -> MatchInfo:
    return seat_info(Batch([course()]), 0, 0, Clock())


@pytest.mark.parametrize(
    ("heights", "flat", "floor"),
    [
        ([], [], 0.1),  # what was not seen is supposed to be free
        ([0.1], [0.1], 0.1),  # ground
        ([0.6], [0.6], 0.6),  # a step
        ([1.1], [1.1], 1.1),  # a ledge to jump on
        ([0.1, 0.6, 1.1, 1.6, 2.1, 2.6], [2.6], None),  # a wall
        ([2.6], [2.6], 0.1),  # a roof: what is below was not seen
        ([0.1, 2.4], [0.1], 0.1),  # below a lintel
        ([0.1, 1.2], [0.1], None),  # below a sill
        ([-5.0], [-5.0], -5.0),  # a drop
        ([1.1], [], None),  # too steep to stand on
    ],
)
def test_what_a_body_finds_in_a_column(
    columns_module: ModuleType, heights: list[float], flat: list[float], floor: float | None
) -> None:
    columns = columns_module.Columns(match_info())
    points = np.array([[10.1, y, 10.1] for y in heights]).reshape(-1, 3)
    columns.see(points, np.isin(points[:, 1], flat))

    entered = columns.enter(columns.cell(10.1, 10.1), columns.level(0.1), was_known=True)

    assert (None if entered is None else entered.height) == (None if floor is None else columns.level(floor))
