"""What RLlib plays: the learners of all matches as a vector environment, and where it runs."""

import socket

import numpy as np
import pytest
from tests.platform.training.learning.common import small
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav.errors import UserError
from wildscav_training.learning.ray_clusters import check_address
from wildscav_training.learning.rllib_env import LearnersVectorEnv, share_of


def test_an_episode_ends_with_its_last_observation_and_the_next_step_starts_another() -> None:
    env = LearnersVectorEnv(small(time_limit=1.0), 4)
    seen, _ = env.reset()
    assert env.observation_space.contains(seen)
    stand, starts = np.zeros((4, 5), np.int64), []
    for _ in range(22):
        _, _, terminated, truncated, _ = env.step(stand)
        starts.append((terminated | truncated).tolist())
    over = [step for step, rows in enumerate(starts) if all(rows)]
    assert over == [9, 20], "ten steps of 0.1 s, then one that only starts the next episode"
    assert len(env.take_ended()) == 8
    assert env.take_ended() == []


def test_processes_play_other_episodes() -> None:
    env = LearnersVectorEnv(small(), 4)
    first, _ = env.reset()
    again, _ = env.reset()
    env.begin(None, 0, part=1)
    other, _ = env.reset()
    assert first.tobytes() == again.tobytes() != other.tobytes()


@pytest.mark.parametrize(("processes", "matches"), [(0, 4), (1, 4), (2, 2), (3, 1)])
def test_processes_share_the_matches(processes: int, matches: int) -> None:
    assert share_of(small(), processes).hyperparameters.matches == matches


@pytest.mark.parametrize("address", ["nowhere", "here:port", "127.0.0.1:0", "ray://127.0.0.1:10001"])
def test_what_is_no_address_is_said(address: str) -> None:
    with pytest.raises(UserError, match="is no address of a Ray cluster: must be HOST:PORT"):
        check_address(address)


def test_a_port_where_nothing_listens_is_said() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{free.getsockname()[1]}"
        with pytest.raises(UserError, match=f"there is no Ray cluster at {address}: Connection refused"):
            check_address(address)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--workers", "2"), "--workers and --address are for rllib-"),
        (("--algorithm", "rllib-ppo", "--address", "127.0.0.1:1"), "--address needs --workers"),
        (("--algorithm", "rllib-ppo", "--workers", "65"), "must be at most 64, the matches at once"),
        (("--algorithm", "rllib-ppo", "--opponents", "self", "--track", "battle"), "not for rllib-ppo"),
    ],
)
def test_what_is_wrong_is_said_before_anything_starts(arguments: tuple[str, ...], says: str) -> None:
    done = CliRunner().invoke(app, ["train", *arguments])
    assert isinstance(done.exception, UserError)
    assert done.exception.exit_code == 2
    assert says in str(done.exception)
