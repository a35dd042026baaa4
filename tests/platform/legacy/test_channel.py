"""The connection to a client: its end is heard of at once, whoever waits for what."""

import contextlib
import threading

import pytest
from tests.platform.legacy.helpers.competitor import Competitor

from wildscav_legacy.channel import LARGEST, Client, ClientGoneError, TooLargeError
from wildscav_legacy.commander_pb2 import GameState, GMCommand
from wildscav_legacy.request_messages import START


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
