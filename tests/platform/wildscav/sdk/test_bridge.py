"""The agent's end of a bridge: what becomes of each kind of answer, and who may play by which interface."""

import json
import math
import socket
from collections.abc import Callable
from pathlib import Path
from threading import Thread

import pytest
from tests.platform.wildscav.skills.observations import match_info

from wildscav import Agent, WildscavError, run
from wildscav.bridge import LONGEST_REQUEST, BridgedSeat, facts_of
from wildscav.errors import AgentError, RefusedError, ServerUnreachableError, UserError
from wildscav.keyboard import KeysSeat
from wildscav.policy.keys import Keys
from wildscav.words import WordsPlayer

HELLO = {"match": {**facts_of(match_info()), "a_fact_of_later_versions": 1}}
Serve = Callable[..., str]


@pytest.fixture
def serve(tmp_path: Path) -> Serve:
    """Serve one agent at a socket: greet it, and give its next request an answer; return the address."""

    def serve(answer: bytes = b"") -> str:
        path = tmp_path / "bridge.sock"
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(str(path))
        listener.listen()

        def talk() -> None:
            with listener, listener.accept()[0] as agent, agent.makefile("rwb") as file:
                for line in (json.dumps(HELLO).encode() + b"\n", answer):
                    file.readline()
                    file.write(line)
                    file.flush()

        Thread(target=talk, daemon=True).start()
        return f"unix:{path}"

    return serve


def test_a_seat_knows_its_match_but_no_places(serve: Serve) -> None:
    with BridgedSeat(serve(), "token") as seat:
        assert (seat.match.track, seat.match.step_time) == (match_info().track, match_info().step_time)
        assert all(map(math.isnan, seat.match.start))
        assert (seat.match.target, seat.match.supply_waves) == (None, ())


@pytest.mark.parametrize(
    ("answer", "error", "message"),
    [
        (b'{"error": "there is no such request"}\n', AgentError, "there is no such request"),
        (b'{"closed": "too many"}\n', RefusedError, "too many"),
        (b"", ServerUnreachableError, "closed the connection before the match was over"),
    ],
)
def test_every_end_has_its_error(
    serve: Serve, answer: bytes, error: type[WildscavError], message: str
) -> None:
    with BridgedSeat(serve(answer), "token") as seat, pytest.raises(error, match=message):
        seat.ask("observe")


def test_what_cannot_be_asked_is_not_sent(serve: Serve) -> None:
    with KeysSeat(serve(), "token") as seat:
        with pytest.raises(AgentError, match="65,536 at most"):
            seat.ask("x" * LONGEST_REQUEST)
        with pytest.raises(AgentError, match="must be JSON"):
            seat.ask("call", arguments={"seconds": math.inf})
        for keys in (Keys(mouse_x=math.nan), {"forward": True}):
            with pytest.raises(AgentError, match="must be Keys"):
                seat.press(keys)  # type: ignore[arg-type]


def test_a_bridge_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(ServerUnreachableError, match=r"no bridge answers at unix:.*: No such file"):
        BridgedSeat(f"unix:{tmp_path / 'nothing'}", "token")


@pytest.mark.parametrize(
    ("interface", "agent", "error", "message"),
    [
        ("words", Agent, AgentError, "Agent must be a subclass of wildscav.words.WordsPlayer, because"),
        ("keys", WordsPlayer, AgentError, "WordsPlayer must be a subclass of wildscav.keyboard.KeysPlayer"),
        ("numbers", WordsPlayer, AgentError, "one that plays by words or keys needs a bridge"),
        ("ears", Agent, UserError, "there is no interface 'ears'; the interfaces are numbers, words, keys"),
    ],
)
def test_an_agent_plays_by_the_interface_of_its_seat(
    monkeypatch: pytest.MonkeyPatch, interface: str, agent: type, error: type[WildscavError], message: str
) -> None:
    for name, value in (("ADDRESS", "unix:/nowhere"), ("TOKEN", "token"), ("INTERFACE", interface)):
        monkeypatch.setenv(f"WILDSCAV_{name}", value)

    with pytest.raises(error, match=message):
        run(agent)
