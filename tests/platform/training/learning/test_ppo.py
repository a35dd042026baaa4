"""The reference PPO: its formulas by hand, its checkpoints bit for bit, and self-play."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest
from tests.platform.training.learning.common import small

from wildscav.errors import UserError
from wildscav_training.learning.opposition import Opposition
from wildscav_training.learning.settings import TrainingSettings

torch = pytest.importorskip("torch")

from wildscav_training.learning import self_play  # noqa: E402
from wildscav_training.learning.ppo import PPO, Choices, Rollout, advantages, divergence_of, entropy_of  # noqa: E402

pytestmark = pytest.mark.slow  # PyTorch is installed for the slow tests alone


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(threads)


def test_actions_are_drawn_with_the_probabilities_of_their_scores() -> None:
    choices = Choices((2, 3))
    scores = torch.tensor([math.log(3.0), 0.0, 0.0, math.log(2.0), 0.0]).repeat(20_000, 1)
    drawn = choices.draw(scores, torch.Generator().manual_seed(0))
    assert drawn.shape == (20_000, 2)
    assert (drawn[:, 0] == 0).float().mean() == pytest.approx(0.75, abs=0.01)
    assert (drawn[:, 1] == 1).float().mean() == pytest.approx(0.5, abs=0.01)
    assert choices.best(scores[0]).tolist() == [0, 1]


def test_the_distribution_has_its_probabilities_entropy_and_divergence() -> None:
    choices = Choices((2, 4))
    uniform = choices.log_probabilities(torch.zeros(1, 6))
    skewed = choices.log_probabilities(torch.tensor([[math.log(3.0), 0.0, 0.0, 0.0, 0.0, 0.0]]))
    assert choices.log_probability(uniform, torch.tensor([[1, 3]])).item() == pytest.approx(-math.log(8.0))
    likely = choices.log_probability(skewed, torch.tensor([[0, 2]]))
    assert likely.item() == pytest.approx(math.log(0.75 / 4.0))
    assert entropy_of(uniform).item() == pytest.approx(math.log(8.0))
    assert divergence_of(uniform, uniform).item() == pytest.approx(0.0)
    wanted = 0.5 * math.log(0.5 / 0.75) + 0.5 * math.log(0.5 / 0.25)
    assert divergence_of(uniform, skewed).item() == pytest.approx(wanted)


@pytest.mark.parametrize(
    ("gae_lambda", "ended", "expected"),
    [
        (0.0, [0.0, 0.0], [1.0 + 0.5 * 4.0 - 2.0, 0.0 + 0.5 * 8.0 - 4.0]),  # one step each
        (1.0, [0.0, 0.0], [1.0 + 0.5 * 0.0 + 0.25 * 8.0 - 2.0, 0.5 * 8.0 - 4.0]),  # all rewards
        (1.0, [1.0, 0.0], [1.0 - 2.0, 0.5 * 8.0 - 4.0]),  # nothing of the next episode
        (1.0, [0.0, 1.0], [1.0 - 2.0, 0.0 - 4.0]),
    ],
)
def test_advantages(gae_lambda: float, ended: list[float], expected: list[float]) -> None:
    def column(values: list[float]) -> Any:
        return torch.tensor(values)[:, None]

    nothing = torch.zeros(2, 1)
    played = Rollout(
        nothing, nothing, nothing, column([2.0, 4.0]), column([1.0, 0.0]), column(ended), nothing == 0
    )
    found = advantages(played, torch.tensor([8.0]), gamma=0.5, gae_lambda=gae_lambda)
    assert found[:, 0].tolist() == pytest.approx(expected)


def trained(settings: TrainingSettings, iterations: int) -> PPO:
    learner = PPO(settings)
    for _ in range(iterations):
        learner.iterate()
    return learner


def weights(learner: PPO) -> list[list[float]]:
    return [
        tensor.reshape(-1).tolist() for tensor in (*learner.policy.parameters(), *learner.value.parameters())
    ]


@pytest.mark.parametrize(
    ("track", "more"),
    [
        ("navigation", {"curriculum": (1.0,)}),  # everyone succeeds, so the stage changes on the way
        ("navigation", {"action_mode": "baseline", "kl_coeff": 0.2, "anneal": False}),
        ("gathering", {"agents": 2, "teams": (0, 0)}),
        ("royale", {"agents": 2, "opponents": ("fighter",)}),
    ],
)
def test_a_run_continues_from_its_state_bit_for_bit(track: str, more: dict[str, Any]) -> None:
    settings = small(track, steps=6400, **more)
    whole = trained(settings, 8)
    first = trained(settings, 4)
    then = PPO(settings)
    then.restore(first.state())
    for _ in range(4):
        figures = then.iterate()
    assert weights(then) == weights(whole) != weights(first)
    assert then.steps == whole.steps > first.steps
    assert all(math.isfinite(figure) for figure in figures.values())


@pytest.mark.parametrize(("failing", "stage"), [([0], 0), ([], 1)])
def test_a_match_that_ends_soon_counts_no_more_often_than_others(failing: list[int], stage: int) -> None:
    """Four matches of a team of two; in some, a step ends an episode, and in others only the time limit."""
    settings = small("capture", steps=10**6, curriculum=(5.0,), agents=2, time_limit=30.0)
    learner = PPO(settings)
    learner.env.set_options(target=(0.0, 0.0, 0.0), start=(0.0, 0.0, 0.0), start_range=None)
    learner.env.set_options(rows=failing, start=(18.0, 0.0, 0.0), time_limit=1e4)
    learner._begin_stage()
    learner._play()
    learner._play()
    assert learner.steps == 2 * 16 * 4 * 2
    assert learner.curriculum.advance() == (stage == 1)


def test_seeds_differ() -> None:
    assert weights(trained(small(seed=1), 1)) != weights(trained(small(seed=2), 1))


def test_a_learner_that_has_left_its_match_is_not_counted() -> None:
    """The zone kills the learners of a royale one by one, so some rows of the rollout are of nobody."""
    settings = small("royale", agents=3, opponents=(), time_limit=20.0, rollout=100)
    learner = trained(settings, 2)
    assert 0 < learner.steps <= 2 * 100 * 4 * 3


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"flat": False}, "needs flat=true and action_mode multidiscrete or fine or baseline"),
        ({"action_mode": "box"}, "needs flat=true"),
        ({"flatt": True}, "the options of the environment: unexpected keyword argument 'flatt'"),
        ({"agents": 0}, "the options of the environment: agents"),
    ],
)
def test_an_environment_that_it_cannot_learn_is_said(more: dict[str, Any], says: str) -> None:
    with pytest.raises(UserError) as caught:
        PPO(small(**more))
    assert says in str(caught.value)


def battle(*names: str, easy_first: bool = False, **changes: Any) -> TrainingSettings:
    opposition = Opposition(names, seats=2, easy_first=easy_first)
    return small("battle", steps=6400, opposition=opposition, sensors={}, time_limit=1.0, **changes)


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


@pytest.mark.parametrize(("total", "joined"), [(7, 7), (20, 20), (25, 20), (100, 20), (119, 20)])
def test_twenty_copies_join_in_a_run_or_one_after_each_rollout(total: int, joined: int) -> None:
    learner = PPO(battle("self"))
    when = []
    for rollouts in range(1, total + 1):
        before = len(learner.opponents.league.sources)
        learner.opponents.after_rollout(rollouts, total, learner.policy)
        if len(learner.opponents.league.sources) > before:
            when.append(rollouts)
    assert len(when) == joined
    assert {after - before for before, after in pairwise(when)} <= {total // joined, -(-total // joined)}


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
    one, other = (PPO(battle("self", "walker", seed=seed)) for seed in (0, 1))
    drawn, others = ([each.env.arena.opponents.names(match) for match in range(4)] for each in (one, other))
    assert drawn != others
    copies = (each.opponents.league.sources["self-0"].random for each in (one, other))
    assert len({copy.initial_seed() for copy in copies}) == 2
