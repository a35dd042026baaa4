"""The next stage begins after a whole window of episodes, if enough of them were successes."""

from typing import Any

import numpy as np
import pytest
from gymnasium.vector import SyncVectorEnv
from tests.engine.envs.common import OPEN, options

from wildscav_engine.envs import AdaptiveOptions, Curriculum, SingleEnv, VectorArena
from wildscav_engine.envs.curriculum import WINDOW, SharedCurriculum


@pytest.mark.parametrize(
    ("successes", "failures", "stage"),
    [
        (WINDOW - 1, 0, 1),  # all succeeded, but too few have ended
        (103, 25, 2),  # 80.5 %
        (102, 26, 1),  # 79.7 %
        (26, 102, 1),  # 20.3 %
        (25, 103, 0),  # 19.5 %
    ],
)
def test_a_stage_is_over_at_eighty_percent_and_begins_again_at_twenty(
    successes: int, failures: int, stage: int
) -> None:
    for down, expected in ((0.2, stage), (None, max(stage, 1))):
        curriculum = Curriculum(3, down=down)
        curriculum.restore({"stage": 1, "results": []})
        curriculum.record([1.0] * successes + [0.0] * failures)
        assert curriculum.advance() == (expected != 1)
        assert curriculum.stage == expected
    alone = Curriculum(1)
    alone.record([1.0] * WINDOW)
    assert not alone.advance()


def test_a_new_stage_counts_anew_and_continues_from_its_state() -> None:
    before = Curriculum(3)
    before.record([0.0] * WINDOW)  # older episodes than the window are forgotten
    before.record([1.0] * WINDOW)
    assert before.advance()
    assert before.state() == {"stage": 1, "results": []}
    before.record([1.0] * (WINDOW - 1))
    after = Curriculum(3)
    after.restore(before.state())
    after.record([1.0])
    assert after.advance()
    assert after.stage == 2


def test_quick_successes_of_some_rows_do_not_open_the_next_stage_for_all() -> None:
    shared = SharedCurriculum(3, rows=5, episodes=5)
    for _ in range(50):
        shared.record_rows([0, 1, 2], [1.0, 1.0, 1.0])
    assert not shared.advance(), "two rows still play their first episode"
    shared.record_rows([3], [0.0])
    again = SharedCurriculum(3, rows=5, episodes=5)
    again.restore(shared.state())
    for curriculum, result, stage in ((shared, 0.0, 0), (again, 1.0, 1)):  # 60 and 80 % of the first episodes
        curriculum.record_rows([4], [result])
        assert curriculum.advance() == (stage == 1)
        assert curriculum.stage == stage


def test_a_later_round_counts_episodes_that_begin_in_it() -> None:
    shared = SharedCurriculum(3, rows=5, episodes=5)
    shared.record_rows([0, 1], [1.0, 1.0])
    shared.record_rows([2, 3, 4], [0.0, 0.0, 0.0])  # the first round ends, while two episodes run
    for stage in (0, 1):  # those two are the first that end, and the next ones count
        shared.record_rows(range(5), [float(row > 1 or stage) for row in range(5)])
        assert shared.advance() == (stage == 1)
    shared.record_rows([0, 1, 2, 3], [1.0] * 4)
    assert shared.advance(), "all begin anew in a new stage, and the fifth cannot change that any more"


@pytest.mark.parametrize(("last", "stage"), [(0.0, 0), (1.0, 1)])  # 75 and 92 %
def test_a_round_has_several_episodes_of_each_of_few_rows(last: float, stage: int) -> None:
    shared = SharedCurriculum(2, rows=2, episodes=5)  # three of each
    shared.record_rows([0, 1], [1.0, 0.5])
    for row in (0, 0, 0, 1):  # the fourth of the first row does not count
        shared.record_rows([row], [1.0])
        assert not shared.advance()
    shared.record_rows([1], [last])
    shared.advance()
    assert shared.stage == stage


STAGES: list[dict[str, Any]] = [{"time_limit": 0.2}, {"time_limit": 0.4, "start_range": 3.0}, {}]
MADE = options("navigation", sensors={}, action_mode="baseline", map=OPEN, time_limit=0.8)


# Two successes lead on. In the next-step mode, every second step begins an episode; in the same-step mode,
# what begins together with a stage does not count.
@pytest.mark.parametrize("flat", [False, True])
@pytest.mark.parametrize(
    ("mode", "stages"),
    [("SameStep", [0, 1, 1, 1, 2, 2, 2]), ("NextStep", [0, 0, 1, 1, 1, 1, 2])],
)
def test_rows_go_their_own_ways(mode: str, stages: list[int], flat: bool) -> None:
    arena = VectorArena("navigation", 2, autoreset_mode=mode, **MADE, flat=flat)
    envs = AdaptiveOptions(arena, STAGES, window=2)
    arena.set_options(target=(0.0, 0.0, 0.0))
    arena.set_options(rows=[0], start=(0.0, 0.0, 0.0))  # in the target: it succeeds at once
    arena.set_options(rows=[1], start=(18.0, 0.0, 0.0))  # it stands still far away
    assert envs.reset(seed=1)[1]["stage"].tolist() == [0, 0]
    told = [envs.step(np.zeros(2, int))[-1]["stage"].tolist() for _ in stages]
    assert told == [[stage, 0] for stage in stages]
    arena.reset(options={"start": (18.0, 0.0, 0.0)})
    ends = [arena.step(np.zeros(2, int))[3].tolist() for _ in range(8)]
    assert [column.index(True) + 1 for column in zip(*ends, strict=True)] == [8, 2]  # steps of 0.1 s


def test_an_episode_that_a_reset_begins_counts_in_the_new_stage() -> None:
    arena = VectorArena("navigation", 2, autoreset_mode="SameStep", **MADE)
    envs = AdaptiveOptions(arena, [{"time_limit": 0.2}] * 3, window=1)
    arena.set_options(target=(0.0, 0.0, 0.0), start=(0.0, 0.0, 0.0))  # each step is a success
    envs.reset(seed=1)
    envs.step(np.zeros(2, int))
    _, infos = envs.reset(options={"reset_mask": np.array([True, False])})
    assert infos["stage"].tolist() == [1, 1]
    assert envs.step(np.zeros(2, int))[-1]["stage"].tolist() == [2, 1]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"metric": "supplies"}, "^metric is 'supplies'; the metrics are time, used_time"),
        ({"stages": [{}, {"levle": "easy"}]}, r"^levle cannot change between episodes \(did you mean 'lev"),
        ({"stages": [{}, {"level": "simple"}]}, "^level: Input should be"),
        ({"stages": [{}, {"map": 10**7}]}, "^map: id is 10000000"),
        ({"stages": []}, "^there are 0 stages"),
        (
            {"env": SyncVectorEnv([lambda: SingleEnv("navigation", **MADE)])},
            "^env is of type SyncVectorEnv, must be a VectorArena, wrapped or not$",
        ),
        ({"down": 0.9}, "^down is 0.9 and up is 0.8, must be less$"),
    ],
)
def test_wrong_stages_are_refused_and_change_nothing(wrong: dict[str, Any], message: str) -> None:
    arena = VectorArena("navigation", 2, **MADE)
    before = arena.config
    with pytest.raises(ValueError, match=message):
        AdaptiveOptions(**{"env": arena, "stages": STAGES, **wrong})
    assert arena.config == before
