"""A seat without a match, for tests of who plays it."""

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from tests.scripted_model import Answer, Script, ScriptedModel, in_turn

from wildscav.errors import AgentError
from wildscav.harness.player import Course, ModelPlayer
from wildscav.harness.settings import ModelSettings


class Tool(NamedTuple):
    """A tool of the seat."""

    name: str
    description: str
    schema: dict[str, Any]


class Reply(NamedTuple):
    """What a call brings."""

    text: str


class PlayedSeat:
    """A seat whose match is over after some calls. Each takes the seconds that it names."""

    match, rules = None, "Reach the target."
    tools = (Tool("go", "Walk.", {"type": "object"}), Tool("wait_until", "Wait.", {"type": "object"}))

    def __init__(self, calls: int = 3) -> None:
        self.left, self.calls = calls, list[tuple[str, dict[str, Any]]]()

    @property
    def is_over(self) -> bool:
        return self.left <= 0

    def observe(self) -> str:
        return "Time: 0.0 s of 60 s, step 0."

    def call(self, name: str, arguments: Mapping[str, Any]) -> Reply:
        if name == "refuse":
            raise AgentError("the bridge refuses this")
        self.calls.append((name, dict(arguments)))
        self.left -= 1
        return Reply(f"{name} ended after 1.0 s: done.\n\nTime: {len(self.calls)}.0 s of 60 s, step 10.")

    def picture(self, *, marks: bool) -> bytes:
        return b"PNG with marks" if marks else b"PNG"


def played(
    script: Script | Answer, seat: PlayedSeat | None = None, *, at_socket: bool = True, **settings: Any
) -> "Played":
    """Let a scripted model play a seat to the end; at a unix socket, or at a URL."""
    seat = seat or PlayedSeat()
    script = script if callable(script) else in_turn(script)
    with (
        TemporaryDirectory() as folder,
        ScriptedModel(script, path=Path(folder) / "model.sock" if at_socket else None) as model,
    ):
        asked = ModelSettings(**{"url": model.url, "pause": 0.001, "retries": 2, **settings})
        course = ModelPlayer(seat, asked).play()
    return Played(course, seat, [request.body for request in model.requests], model)


class Played(NamedTuple):
    """How it went."""

    course: Course
    seat: PlayedSeat
    requests: list[dict[str, Any]]
    model: ScriptedModel

    def told(self, request: int) -> str:
        """Return all texts of a request's messages, one after the other."""
        contents = [message.get("content") or "" for message in self.requests[request]["messages"]]
        return "\n".join(content if isinstance(content, str) else repr(content) for content in contents)
