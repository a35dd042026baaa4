"""The league: who is chosen how often, whose results count, and who is dropped."""

import json
from collections import Counter
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from tests.engine.envs.common import batch_of, digest, env_id, options

from wildscav_engine.envs import BatchedArena, League, PolicyOpponent, Sampler, SingleEnv, VectorArena
from wildscav_engine.envs.league import LeagueError
from wildscav_engine.simulation.snapshot import StateError

ALONE: dict[str, Any] = {"latest_share": 0.0, "robot_share": 0.0}
IDLE = np.zeros(8, np.float32)


def stand(observation: Any) -> np.ndarray:
    return np.zeros((len(observation), 8))


def battle(**more: Any) -> dict[str, Any]:
    return options("battle", **{"sensors": {}, "flat": True, "action_mode": "box", "time_limit": 0.4, **more})


def league_of(*names: str, **settings: Any) -> League:
    league = League(**settings)
    for name in names:
        league.add(stand, name)
    return league


@pytest.mark.parametrize(
    ("weighting", "wanted"),
    [
        # After one win against a and one loss against b, the win rates are 2/3, 1/3 and, for c, 1/2.
        ("hard", [1 / 9, 4 / 9, 1 / 4]),  # (1 - p)²
        ("variance", [2 / 9, 2 / 9, 1 / 4]),  # p (1 - p)
        ("uniform", [1.0, 1.0, 1.0]),
    ],
)
def test_the_win_rate_decides_how_often_an_opponent_is_chosen(weighting: Any, wanted: list[float]) -> None:
    league = league_of("a", "b", "c", weighting=weighting, **ALONE)
    league.record("a", 1.0)
    league.record("b", 0.0)
    chances = league.probabilities()
    assert list(chances) == ["a", "b", "c"]
    assert list(chances.values()) == pytest.approx([weight / sum(wanted) for weight in wanted])


@pytest.mark.parametrize(
    ("games", "extreme"),
    [
        (2500.0, {"power": 100.0, "memory": 1.0}),
        (1e300, {"power": 100.0, "memory": 1.0}),
        (1e300, {"weighting": "variance", "memory": 1.0}),
        (10.0, {"power": 100.0, "memory": 1e-300}),
        (3.0, {"latest_share": 0.9, "robot_share": 0.1}),
        (3.0, {"latest_share": 1.0, "robot_share": 0.0, "capacity": 1}),
    ],
)
def test_a_league_chooses_under_the_most_extreme_settings(games: float, extreme: dict[str, Any]) -> None:
    league = league_of("a", "b", robots=("walker", "fighter"), **{**ALONE, **extreme})
    won = {"recent": games, "recent_score": games}
    members = tuple(one.model_copy(update=won) for one in league.table.members)
    table = league.table.model_copy(update={"members": members})
    chances = League.of(table, league.sources).probabilities()
    assert min(chances.values()) >= 0.0
    assert sum(chances.values()) == pytest.approx(1.0)
    if "latest_share" not in extreme:  # all were beaten as often
        assert chances["a"] == chances["b"] == pytest.approx(0.5)


def test_the_newest_and_the_robots_have_shares_of_their_own() -> None:
    league = league_of("a", "b", robots=("walker", "fighter"), latest_share=0.3, robot_share=0.2)
    chances = league.probabilities()
    assert chances == pytest.approx({"a": 0.25, "b": 0.55, "walker": 0.1, "fighter": 0.1})
    assert League(robots=("walker",)).probabilities() == {"walker": 1.0}
    with pytest.raises(LeagueError, match="the league is empty: add a policy, or give it robots"):
        League().probabilities()


def test_a_seed_gives_the_same_opponents_and_shares_are_kept() -> None:
    league = league_of("a", "b", robots=("walker",), latest_share=0.3, robot_share=0.2)

    def drawn(seed: int) -> list[str]:
        return _names(league.sample(4, Random(seed)))  # noqa: S311

    assert drawn(7) == drawn(7)
    counts = Counter(name for seed in range(500) for name in drawn(seed))
    shares = {name: counts[name] / 2000 for name in sorted(counts)}
    assert shares == pytest.approx({"a": 0.25, "b": 0.55, "walker": 0.2}, abs=0.03)


def _names(players: Any) -> list[str]:
    return [player if isinstance(player, str) else player.name for player in players]


def test_older_results_weigh_less() -> None:
    league = league_of("a", memory=0.5)
    for result in (0.0, 0.0, 0.5, 1.0):
        league.record("a", result)
    results = league.results["a"]
    assert (results.wins, results.draws, results.losses, results.games) == (1, 1, 2, 4)
    # 1 + 1/2 + 1/4 + 1/8 games; 1 + 0.5 × 1/2 points; and one win and one loss more.
    assert results.win_rate == pytest.approx((1.25 + 1) / (1.875 + 2))


def test_the_one_that_is_always_beaten_is_dropped_and_never_the_newest() -> None:
    league = league_of("a", "b", "c", capacity=3)
    for name, result in (("a", 0.0), ("b", 1.0), ("c", 1.0)):
        league.record(name, result)
    league.add(stand, "d")
    assert list(league.results) == ["a", "c", "d"]  # b is older than c, and beaten as often
    for _ in range(5):
        league.record("d", 1.0)
    league.record("b", 1.0)  # a game that was still running
    league.add(stand)
    assert list(league.results) == ["a", "c", "self-5"]
    assert list(league.sources) == ["a", "c", "self-5"]


@pytest.mark.parametrize("carried", [0, 3, 5])
def test_an_environment_records_the_results_of_its_episodes(carried: int) -> None:
    league = league_of("a", latest_share=1.0, robot_share=0.0)
    vector = VectorArena("battle", 2, **battle(opponents=(league, "walker", league)))
    for episode in range(1, 3):
        vector.reset(seed=episode)
        for step in range(4):
            batch_of(vector).state.agents.supplies[:] = 3, carried, 0, 0
            assert league.results["a"].games == 4 * (episode - 1), step
            vector.step(np.tile(IDLE, (2, 1)))
        results = league.results["a"]
        # The league plays seats 1 and 3 of both matches; who has seat 3 carries nothing.
        against_first = [result * 2 * episode for result in (carried < 3, carried == 3, carried > 3)]
        assert (results.wins - 2 * episode, results.draws, results.losses) == tuple(against_first)


def by_gymnasium(**more: Any) -> Any:
    return gymnasium.make(env_id("battle"), **more)


def vector_by_gymnasium(**more: Any) -> Any:
    return gymnasium.make_vec(env_id("battle"), 2, vectorization_mode="vector_entry_point", **more)


@pytest.mark.parametrize(
    ("make", "shape", "games"),
    [
        (by_gymnasium, (8,), 1),  # Gymnasium passes on the very league
        (vector_by_gymnasium, (2, 8), 2),
        # While a match waits for a reset, its result counts once.
        (partial(VectorArena, "battle", 2, autoreset_mode="Disabled"), (2, 8), 2),
        # Several learners of one team have one result: against the pair, and against the third.
        (partial(BatchedArena, "battle", 1, agents=3, teams=(0, 0, 1, 2)), (1, 3, 8), 2),
    ],
)
def test_each_match_has_a_result_for_each_team_of_learners(make: Any, shape: Any, games: int) -> None:
    league = league_of("a", latest_share=1.0, robot_share=0.0)
    env = make(**battle(opponents=(league,)))
    env.reset(seed=0)
    for _ in range(4):
        env.step(np.zeros(shape, np.float32))
    if getattr(env, "autoreset_mode", None) == AutoresetMode.DISABLED:
        for _ in range(3):
            env.reset(options={"reset_mask": np.array([True, False])})
    assert league.results["a"].games == games


def test_each_policy_is_called_once_per_step_for_all_its_seats() -> None:
    calls: list[tuple[str, int]] = []

    def called(name: str) -> Any:
        def policy(observation: Any) -> np.ndarray:
            calls.append((name, len(observation)))
            return stand(observation)

        return policy

    league = League(robots=("walker",), robot_share=0.2, latest_share=0.3)
    for name in "abc":
        league.add(called(name), name)
    vector = VectorArena("battle", 16, **battle(opponents=(league,) * 3))
    vector.reset(seed=0)
    seats = Counter()
    for _ in range(15):
        asked = [spec.seats[1:].count("submission") for spec in batch_of(vector).specs]
        ended = vector._autoreset.ended.copy()
        calls.clear()
        vector.step(np.tile(IDLE, (16, 1)))
        assert len({name for name, _ in calls}) == len(calls) <= 3
        assert sum(count for _, count in calls) == (0 if ended.all() else sum(asked))
        seats.update(dict(calls))
    assert set(seats) == {"a", "b", "c"}
    assert seats["c"] > seats["a"]


def test_the_same_seed_and_table_give_the_same_episodes_in_rows_and_single_environments() -> None:
    leagues = (league_of("a", robots=("walker", "fighter"), robot_share=0.5) for _ in range(2))
    vector, single = (
        make("battle", **battle(opponents=(league,) * 2))
        for make, league in zip((partial(VectorArena, num_envs=3), SingleEnv), leagues, strict=True)
    )
    vector.reset(seed=4)
    single.reset(seed=6)
    assert batch_of(vector).specs[2] == batch_of(single).specs[0]
    for _ in range(3):
        assert digest(vector.step(np.tile(IDLE, (3, 1)))[0][2].copy()) == digest(single.step(IDLE)[0])


def test_a_state_continues_against_the_same_members_and_does_not_count() -> None:
    league = league_of("a", "b", "c", robots=("walker",))
    env = SingleEnv("battle", **battle(opponents=(league,) * 4))
    env.reset(seed=1)
    state = env.get_state()
    names, seats = env.arena.opponents.names(0), batch_of(env).specs[0].seats
    env.reset()
    env.set_state(state)
    assert (env.arena.opponents.names(0), batch_of(env).specs[0].seats) == (names, seats)
    for _ in range(4):
        env.step(IDLE)
    assert sum(results.games for results in league.results.values()) == 0
    with pytest.raises(StateError, match=r"the state is of a match with '.*': the league has no '.*'"):
        SingleEnv("battle", **battle(opponents=(league_of("z"),) * 4)).set_state(state)


def test_a_league_is_saved_and_loaded_with_its_results(tmp_path: Path) -> None:
    made: list[int] = []

    def factory(parameters: int) -> PolicyOpponent:
        made.append(parameters)
        return PolicyOpponent(stand, flat=True)

    league = League(factory=factory, robots=("walker",), capacity=2, power=3.0)
    for parameters in (1, 2, 3):
        league.add(parameters)
    league.record("self-3", 1.0)
    league.record("walker", 0.5)
    league.save(tmp_path / "league.json")
    again = League.load(tmp_path / "league.json", league.sources, factory=factory)
    assert made == [1, 2, 3, 2, 3]
    assert (again.settings, again.results) == (league.settings, league.results)
    assert again.probabilities() == league.probabilities()
    assert again.add(4) == "self-4"
    assert json.loads((tmp_path / "league.json").read_text())["added"] == 3
    assert [path.name for path in tmp_path.iterdir()] == ["league.json"]
    with pytest.raises(LeagueError, match="lists self-3, which sources does not contain"):
        League.load(tmp_path / "league.json", {"self-2": 2}, factory=factory)


@pytest.mark.parametrize(
    "content",
    [
        *("", "[]", '{"format": 2}', '{"members": [{"name": "a", "wins": -1}]}'),
        '{"members": [{"name": "a", "recent": 1, "recent_score": 2}]}',
    ],
)
def test_what_is_not_a_table_is_refused(tmp_path: Path, content: str) -> None:
    path = tmp_path / "league.json"
    path.write_text(content)
    with pytest.raises(LeagueError, match=r"league.json is not the table of a league: .+"):
        League.load(path, {})


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"weighting": "fair"}, "weighting: Input should be 'hard', 'variance' or 'uniform'"),
        ({"capacity": 0}, "capacity: .* greater than or equal to 1"),
        ({"latest_share": 0.7, "robot_share": 0.4}, "must be at most 1 together"),
        ({"robots": ("wakler",)}, r"no robot 'wakler' \(did you mean 'walker'"),
    ],
)
def test_wrong_settings_are_refused(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        League(**wrong)


def test_wrong_members_and_results_are_refused() -> None:
    league = league_of("a", robots=("walker",))
    for name in ("a", "walker"):
        with pytest.raises(LeagueError, match=f"already has '{name}'"):
            league.add(stand, name)
    with pytest.raises(ValueError, match="7 cannot play"):
        league.add(7)
    with pytest.raises(LeagueError, match="'fighter' is a robot"):
        league.add("fighter")
    with pytest.raises(LeagueError, match=r"the result is 2, must be 0, 0\.5 or 1"):
        league.record("a", 2)
    assert list(league.results) == ["a", "walker"]


def test_a_sampler_that_returns_too_few_players_is_refused() -> None:
    class Lazy(Sampler):
        def sample(self, seats: int, random: Random) -> list[Any]:
            return []

    env = SingleEnv("battle", **battle(opponents=(Lazy(),) * 2))
    with pytest.raises(ValueError, match=r"Lazy\.sample returned 0 players for 2 seats"):
        env.reset(seed=0)


def test_a_robot_joins_later() -> None:
    league = League(robots=("walker",), robot_share=1.0, latest_share=0.0)
    league.add_robot("fighter-easy")
    assert league.probabilities() == {"walker": 0.5, "fighter-easy": 0.5}
    assert League.of(league.table, {}).results == league.results
    with pytest.raises(LeagueError, match="already has 'walker'"):
        league.add_robot("walker")
    with pytest.raises(ValueError, match="there is no robot 'figther'"):
        league.add_robot("figther")
