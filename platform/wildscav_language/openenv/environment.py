"""One seat of a match as an environment of OpenEnv: a step is a call of a tool."""

import base64
import secrets
from typing import Annotated, Any

from openenv.core.env_server.interfaces import Environment
from openenv.core.env_server.mcp_types import Tool
from openenv.core.env_server.types import EnvironmentMetadata
from pydantic import Field, ValidationError

from wildscav.errors import UserError
from wildscav.version import __version__
from wildscav_engine.specs.validation import one_line
from wildscav_language.calls import Reason
from wildscav_language.mcp_server.requests import StartMatch
from wildscav_language.openenv.host import Host, HostedEpisode
from wildscav_language.openenv.models import WildscavAction, WildscavObservation, WildscavState
from wildscav_language.rules_text import rules

NOT_BEGUN = "No match has begun: call reset first."
OVER = "The match is over: call reset to begin another."


class Episode(StartMatch):
    """The options of ``reset``."""

    clients: Annotated[int, Field(ge=1, le=1)] = 1  # an environment plays one seat
    pictures: bool = False  # whether observations have one
    episode_id: Annotated[str, Field(pattern=r"^[\w-]{1,64}$")]  # the name of the record begins with it


class WildscavEnvironment(Environment[WildscavAction, WildscavObservation, WildscavState]):
    """Plays one seat of one match after another; robots and baselines play the others.

    Args:
        host: Where its matches are played; several environments may share one.
    """

    SUPPORTS_CONCURRENT_SESSIONS = True

    def __init__(self, host: Host) -> None:
        super().__init__()
        self._host = host
        self._episode: HostedEpisode | None = None
        self._state = WildscavState()
        self._score = 0.0  # as of the last observation

    def reset(
        self, seed: int | None = None, episode_id: str | None = None, **kwargs: Any
    ) -> WildscavObservation:
        """Begin a match; one that is not over is given up.

        Args:
            seed: Of the map, the starts and the goals: the same seed and the same calls give the same match.
            episode_id: Names the episode, and begins the name of its record; by default, a random one.
            kwargs: See ``Episode``.

        Raises:
            UserError: There is no such match; the message says what is wrong.
        """
        seed = secrets.randbelow(2**31) if seed is None else seed
        name = secrets.token_hex(8) if episode_id is None else episode_id
        request = _request({**kwargs, "seed": seed, "episode_id": name})
        episode = self._host.start(request, name)
        self.close()
        self._episode, self._score = episode, episode.score
        options = request.model_dump(exclude={"clients", "episode_id"}, mode="json")
        self._state = WildscavState(episode_id=name, options=options)
        seat = episode.seat
        tools = [
            Tool(name=tool.name, description=tool.description, input_schema=tool.schema)
            for tool in seat.tools
        ]
        told = self._told(episode, f"{rules(seat.match)}\n\n{seat.observe()}", "", 0)
        told.reward, told.tools = None, tools
        return told

    def step(
        self,
        action: WildscavAction,
        timeout_s: float | None = None,  # noqa: ARG002 - a call ends when its tool does
        **kwargs: Any,  # noqa: ARG002
    ) -> WildscavObservation:
        """Play a call until its tool ends. A bad call costs game time, and is answered with what is allowed.

        Raises:
            UserError: No match has begun, or it is over.
        """
        episode = self._episode
        if episode is None:
            raise UserError(OVER if self._state.ending else NOT_BEGUN)
        self._state.step_count += 1
        if episode.hosted.seats[0].gone:
            episode.seat.leave()  # since a seat that the server has closed waits for a call
        before = episode.seat.counts.steps
        reply = episode.seat.call(action.tool, action.arguments)
        if not reply.over:
            return self._told(episode, reply.text, reply.ended, reply.steps)
        steps = episode.seat.counts.steps - before
        self._state.ending = self._host.ending(episode)
        self._state.record = episode.record.name if episode.record and episode.record.exists() else None
        told = self._told(episode, self._state.ending, Reason.MATCH_OVER, steps, done=True)
        self.close()
        return told

    @property
    def state(self) -> WildscavState:
        """What is known of the episode."""
        return self._state

    def get_metadata(self) -> EnvironmentMetadata:
        """Return what the environment is."""
        return EnvironmentMetadata(
            name="wildscav",
            description="A 3D world of navigation, gathering and battle, played by words and typed tools.",
            version=__version__,
        )

    def close(self) -> None:
        """Give up the match, if one is played."""
        if self._episode is not None:
            self._host.abandon(self._episode)
            self._episode = None

    def _told(
        self, episode: HostedEpisode, text: str, ended: str, steps: int, *, done: bool = False
    ) -> WildscavObservation:
        """Return an observation after a call that took some steps."""
        seat, score = episode.seat, episode.score
        gained, self._score = score - self._score, score
        has_picture = self._state.options["pictures"] and not done
        return WildscavObservation(
            text=text,
            ended=ended,
            picture=base64.b64encode(episode.picture()).decode() if has_picture else None,
            done=done,
            reward=gained,
            metadata={
                "steps": steps,
                "seconds": round(steps * seat.match.step_time, 3),
                "calls": seat.counts.calls,
                "refused": seat.counts.refused,
                "score": score,
            },
        )


def _request(options: dict[str, Any]) -> Episode:
    """Return what a reset asks for.

    Raises:
        UserError: An option does not exist, or has a wrong value.
    """
    try:
        return Episode.model_validate(options)
    except ValidationError as error:
        known = ", ".join(name for name in Episode.model_fields if name != "clients")
        raise UserError(f"reset takes {known}; {one_line(error)}") from None
