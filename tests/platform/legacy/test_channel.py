"""The connection to a client, and the end of a session: the client may go or close at any time."""

import contextlib
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.platform.legacy.helpers.commands import command
from tests.platform.legacy.helpers.competitor import Competitor

from wildscav_legacy.channel import LARGEST, Client, ClientGoneError, TooLargeError
from wildscav_legacy.commander_pb2 import GameMode, GameState, GMCommand
from wildscav_legacy.request_messages import START
from wildscav_legacy.session import Session


@pytest.mark.parametrize("watched", [True, False])
def test_a_client_that_goes_while_nothing_is_asked_is_missed_if_it_is_watched(watched: bool) -> None:
    competitor, gone = Competitor(), threading.Event()
    client = Client(f"127.0.0.1:{competitor.port}")
    client.on_gone(gone.set)

    with client.watched() if watched else contextlib.nullcontext():
        competitor.die()
        heard = gone.wait(5.0 if watched else 0.5)

    assert heard == watched
    client.close()


def test_a_question_hears_by_itself_that_the_client_has_gone() -> None:
    competitor = Competitor()
    client = Client(f"127.0.0.1:{competitor.port}")
    threading.Timer(0.3, competitor.die).start()

    with pytest.raises(ClientGoneError, match="has gone"):
        client.ask(START)
    client.close()


@pytest.mark.parametrize("size", [LARGEST // 2, LARGEST, 40 * LARGEST])
def test_a_reply_that_no_episode_needs_is_not_taken_in(size: int) -> None:
    competitor = Competitor()
    client = Client(f"127.0.0.1:{competitor.port}")
    competitor.reply(GameState.RESET, gm_cmd=GMCommand(replay_suffix="x" * size))

    if size < LARGEST:
        assert len(client.ask(START).gm_cmd.replay_suffix) == size
    else:
        with pytest.raises(TooLargeError, match="sent a reply of more than 1 MiB"):
            client.ask(START)
    client.close()
    competitor.die()


def test_a_port_where_nobody_listens_is_named() -> None:
    with pytest.raises(ClientGoneError, match=r"no client answers on 127\.0\.0\.1:1"):
        Client("127.0.0.1:1", timeout=0.1)


Playing = tuple[Competitor, threading.Thread]


@pytest.fixture
def playing(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> Iterator[Playing]:
    """A client whose engine has made its first call, and that engine."""
    caplog.set_level("INFO", "wildscav_legacy")
    competitor = Competitor()
    client = Client(f"127.0.0.1:{competitor.port}")
    engine = threading.Thread(target=Session(client, tmp_path).run)
    engine.start()
    competitor.wait()
    yield competitor, engine
    client.close()
    competitor.die()


@pytest.mark.parametrize(
    ("actions", "ended", "said"),
    [
        (None, "closed by the client after 0 episodes", ""),
        (4, "closed by the client after 1 episode", "episode 1: interrupted after 20 frames"),
        (10, "closed by the client after 1 episode", "episode 1: time up after 50 frames"),
    ],
)
def test_close_ends_the_engine_before_in_and_after_an_episode(
    playing: Playing, caplog: pytest.LogCaptureFixture, actions: int | None, ended: str, said: str
) -> None:
    competitor, engine = playing
    if actions is not None:
        competitor.begin(command(timeout=1))
        competitor.act(times=actions)
    competitor.close()
    engine.join(timeout=120)
    assert not engine.is_alive()
    assert ended in caplog.messages
    assert said in caplog.text


def test_a_reply_that_belongs_to_no_episode_is_told_and_asked_again(
    playing: Playing, caplog: pytest.LogCaptureFixture
) -> None:
    competitor, engine = playing
    first = competitor.latest
    assert competitor.act() == first
    competitor.close()
    engine.join(timeout=120)
    assert not engine.is_alive()
    assert "the client replies 2, but no episode is being played" in caplog.messages


def test_more_agents_than_the_client_has_room_for_are_told_as_such(tmp_path: Path) -> None:
    """A message of 300 agents, each with 299 enemies, is larger than the 4 MB that gRPC takes by default."""
    competitor = Competitor()
    client = Client(f"127.0.0.1:{competitor.port}")
    competitor.reply(GameState.RESET, gm_cmd=command(GameMode.SUP_BATTLE_MODE, num_agents=300))
    with pytest.raises(
        TooLargeError, match=r"does not accept a message of \d+\.\d MB.*fewer agents or supplies"
    ):
        Session(client, tmp_path).run()
    client.close()
    competitor.die()
