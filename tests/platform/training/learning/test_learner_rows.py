"""The learners of a batch as rows: what trainers of other libraries see is what the batch plays."""

import numpy as np
import pytest
from tests.platform.training.learning.common import small

from wildscav.errors import UserError
from wildscav_training.learning.environment import APART, make_env, sizes_of
from wildscav_training.learning.learner_rows import LearnerRows, successes


@pytest.mark.parametrize(
    ("track", "more"), [("navigation", {}), ("gathering", {"agents": 2, "teams": (0, 0)})]
)
def test_rows_are_the_learners_match_by_match(track: str, more: dict[str, object]) -> None:
    settings = small(track, seed=3, **more)
    rows, env = LearnerRows(settings, None), make_env(settings, 4, None)
    seen, told = rows.reset(), env.reset(seed=3 * APART)
    random, sizes = np.random.default_rng(0), sizes_of(env)
    assert rows.count == 4 * env.num_agents
    returns, ended = np.zeros(rows.count), []
    for _ in range(40):  # longer than an episode
        assert seen.tobytes() == told.tobytes()  # type: ignore[union-attr]
        actions = random.integers(0, sizes, (rows.count, len(sizes)))
        outcome, batch = rows.step(actions), env.step(actions.reshape(4, env.num_agents, -1))
        seen, told = outcome.seen, batch.observation
        returns += batch.rewards.reshape(-1)
        ended += outcome.ended
        assert outcome.rewards == pytest.approx(batch.rewards.reshape(-1))
        assert outcome.terminated.tolist() == batch.terminated.reshape(-1).tolist()
        assert outcome.truncated.tolist() == batch.truncated.reshape(-1).tolist()
        assert (outcome.last is None) == (not batch.ended)
        if outcome.last is not None and batch.final is not None:
            assert outcome.last.tobytes() == batch.final.observation.tobytes()  # type: ignore[union-attr]
    assert len(ended) >= rows.count
    assert sum(one["return"] for one in ended) + rows.returns.sum() == pytest.approx(returns.sum())


def test_rows_continue_from_their_state() -> None:
    settings = small()
    first, then = LearnerRows(settings, None), LearnerRows(settings, None)
    first.reset()
    stand = np.zeros((4, 5), np.int64)
    for _ in range(5):
        first.step(stand)
    then.restore(first.state(), first.returns)
    for _ in range(40):
        assert first.step(stand).seen.tobytes() == then.step(stand).seen.tobytes()
    assert first.returns.tolist() == then.returns.tolist()


def test_only_tracks_with_a_target_have_successes() -> None:
    assert successes([{"return": 1.0, "success": 1.0}, {"return": 0.0, "success": 0.0}]) == [1.0, 0.0]
    assert successes([{"return": 3.0, "supplies": 9.0}]) == []


def test_learners_that_leave_one_by_one_are_no_rows() -> None:
    with pytest.raises(
        UserError, match="learns royale with one learner, since several would leave one by one"
    ):
        LearnerRows(small("royale", agents=3, opponents=(), algorithm="a2c"), None)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (
            {"flat": False},
            "the algorithm a2c needs flat=true and action_mode multidiscrete or fine or baseline",
        ),
        ({"action_mode": "box"}, "the algorithm a2c needs flat=true"),
        ({"flatt": True}, "the options of the environment: unexpected keyword argument 'flatt'"),
    ],
)
def test_an_environment_that_cannot_be_learned_is_said(more: dict[str, object], says: str) -> None:
    with pytest.raises(UserError) as caught:
        LearnerRows(small(algorithm="a2c", **more), None)
    assert says in str(caught.value)
