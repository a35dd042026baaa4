"""Self-play: who joins the league and when, and runs that continue bit for bit."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest
from tests.platform.training.learning.common import small

from wildscav_training.learning.opposition import Opposition
from wildscav_training.learning.settings import TrainingSettings

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.slow  # PyTorch is installed for the slow tests alone

from wildscav_training.learning import self_play  # noqa: E402
from wildscav_training.learning.ppo import PPO  # noqa: E402


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(threads)


def battle(*names: str, easy_first: bool = False, **changes: Any) -> TrainingSettings:
    opposition = Opposition(names, seats=2, easy_first=easy_first)
    return small("battle", steps=6400, opposition=opposition, sensors={}, time_limit=1.0, **changes)


def trained(settings: TrainingSettings, iterations: int) -> PPO:
    learner = PPO(settings)
    for _ in range(iterations):
        learner.iterate()
    return learner


def weights(learner: PPO) -> list[Any]:
    return [tensor.tolist() for tensor in (*learner.policy.parameters(), *learner.value.parameters())]


@pytest.mark.parametrize("more", [{}, {"agents": 2, "teams": (0, 1, 2, 3)}, {"action_mode": "baseline"}])
def test_a_run_against_itself_continues_from_its_state_bit_for_bit(more: dict[str, Any]) -> None:
    settings = battle("self", "walker", "fighter", easy_first=True, **more)
    whole, first, then = trained(settings, 8), trained(settings, 5), PPO(settings)
    assert first.total > self_play.COPIES, "copies join on the way"
    then.restore(first.state())
    for _ in range(3):
        figures = then.iterate()
    assert weights(then) == weights(whole) != weights(first)
    assert then.opponents.league.table == whole.opponents.league.table
    assert {"self-0", "self-1", "walker-easy", "fighter-easy"} <= set(then.opponents.league.results)
    games = sum(each.games for each in then.opponents.league.results.values())
    assert games > 0, "matches that were restored count"
    assert 0.0 < figures["win rate/fighter-easy"] < 1.0


def test_copies_of_the_policy_join_evenly_and_learn_no_more() -> None:
    learner = trained(battle("self"), 11)
    copies = learner.opponents.league.sources
    assert learner.total == 100
    assert list(copies) == ["self-0", "self-1", "self-2"], "before the first rollout, after 5 and after 10"
    last = copies["self-2"].network[-1].weight
    assert last.abs().max() > copies["self-0"].network[-1].weight.abs().max(), "it had learned something"
    assert not last.requires_grad
    learner.iterate()
    assert not torch.equal(last, learner.policy[-1].weight)


def test_the_next_level_of_a_robot_joins_when_the_learner_beats_the_present_one() -> None:
    learner = PPO(battle("fighter-hard", easy_first=True))
    league = learner.opponents.league
    assert set(league.results) == {"fighter-easy"}
    for games, joined in ((self_play.GAMES - 1, False), (1, True)):
        for _ in range(games):
            league.record("fighter-easy", 1.0)
        learner.opponents.after_rollout(1, 100, learner.policy)
        assert ("fighter" in league.results) is joined
    for _ in range(self_play.GAMES):
        league.record("fighter", 0.0)
    learner.opponents.after_rollout(2, 100, learner.policy)
    assert "fighter-hard" not in league.results
    assert league.probabilities()["fighter"] > league.probabilities()["fighter-easy"]


def test_a_submission_plays_and_its_run_continues_with_other_matches() -> None:
    settings = battle("hunter", "self")
    learner = trained(settings, 2)
    assert learner.opponents.league.results["hunter"].games > 0
    state = learner.state()
    assert state["matches"] == []
    then = PPO(settings)
    then.restore(state)
    assert weights(then) == weights(learner)
    then.iterate()
    assert then.steps > learner.steps


def test_seeds_draw_other_opponents() -> None:
    one, other = (trained(replace(battle("self", "walker"), seed=seed), 3) for seed in (0, 1))
    assert one.opponents.league.table.members[0].games > 0
    assert weights(one) != weights(other)
