"""A seat that a caller plays by words: an agent on one side, texts and tools on the other.

The agent is an ordinary ``wildscav.Agent``, which some thread plays. When a tool has ended, its ``act``
blocks until the caller's next call, so the match should be one that waits for its seats.
"""

import threading
import time
from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from wildscav.agent import Action, Agent, MatchInfo, Observation
from wildscav.words import Reply
from wildscav_language.calls import Reason, Tool
from wildscav_language.pictures import picture
from wildscav_language.player import Counts, Player

__all__ = ["Counts", "Reply", "Seat", "Tool", "WordsAgent"]

START_TIME = 60.0  # s to wait for a match to begin


class WordsAgent(Agent):
    """Plays what the caller of a ``Seat`` says."""

    def __init__(self, seat: "Seat") -> None:
        self._seat = seat

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self._seat.begin(match)

    def act(self, observation: Observation) -> Action:
        """Return the next action of the running tool; wait for a call if none is running."""
        return self._seat.answer(observation)


class Seat:
    """The caller's side of a seat. Any thread may call its methods; one call is played at a time.

    Args:
        names: The display names of all seats of the match, which texts quote.
    """

    def __init__(self, names: Sequence[str] = ()) -> None:
        self.agent = WordsAgent(self)
        self._names = names
        self._changed = threading.Condition()
        self._player: Player | None = None
        self._has_left = False
        self._is_over = False

    @property
    def tools(self) -> tuple[Tool, ...]:
        """The tools of the match's track and senses; waits for the match to begin."""
        with self._changed:
            return self._begun(START_TIME).tools

    @property
    def match(self) -> MatchInfo:
        """What is known of the match; waits for it to begin."""
        return self.begun()

    @property
    def counts(self) -> Counts:
        """How many calls were made and refused so far, and how many steps were played."""
        with self._changed:
            return Counts() if self._player is None else self._player.counts

    @property
    def step(self) -> int:
        """The step that the match was at when the seat last sensed something; 0 before that."""
        with self._changed:
            return self._player.body.now.step if self._player is not None and self._has_begun() else 0

    @property
    def is_over(self) -> bool:
        """Whether the match is over, or the caller has left."""
        return self._is_over or self._has_left

    def begun(self, timeout: float = START_TIME) -> MatchInfo:
        """Return what is known of the match, which has some seconds to begin.

        Raises:
            TimeoutError: It did not begin.
        """
        with self._changed:
            return self._begun(timeout).match

    def observe(self, timeout: float = START_TIME) -> str:
        """Return the text of now, 8,000 bytes at most. The match has some seconds to begin.

        Raises:
            TimeoutError: It did not begin.
        """
        with self._changed:
            return self._begun(timeout).text()

    def picture(self, image: NDArray[Any] | None = None, *, marks: bool = False) -> bytes:
        """Return what the seat's camera shows, as a PNG file of less than 1 MiB.

        Args:
            image: What a camera with the options ``PICTURE`` shows now; by default, that of the observation.
            marks: Whether the boxes and agents that the seat is told of have their numbers in it.

        Raises:
            TimeoutError: The match did not begin.
            ValueError: The seat has no camera.
        """
        with self._changed:
            now = self._begun(START_TIME).body.now
        image = now.tensors.get("camera") if image is None else image
        if image is None:
            raise ValueError("this seat has no camera: host its match with sensors(pictures=True)")
        return picture(image, now, marks=marks)

    def call(self, name: str, arguments: Mapping[str, Any], timeout: float | None = None) -> Reply:
        """Play a tool until it ends. A bad call is answered with what is allowed, and costs game time.

        Args:
            name: Of the tool.
            arguments: As its schema says.
            timeout: Seconds to wait for its end. Then the reply's reason is ``playing``: the tool goes on,
                and ``wait`` returns its reply.

        Raises:
            TimeoutError: The match did not begin, or another call is still being played.
        """
        with self._changed:
            player, left = self._begun_within(timeout)
            began = time.monotonic()
            if not self._changed.wait_for(lambda: self.is_over or player.wants_call, left):
                raise TimeoutError("another call is still being played")
            if not self.is_over:
                player.give(name, arguments)
                self._changed.notify_all()
            return self._reply(player, None if left is None else left - (time.monotonic() - began))

    def wait(self, timeout: float | None = None) -> Reply:
        """Return the reply of the running tool, or that of the last one. For its timeout, see ``call``.

        Raises:
            TimeoutError: The match did not begin.
        """
        with self._changed:
            return self._reply(*self._begun_within(timeout))

    def leave(self) -> None:
        """Let the body stand still from now on."""
        with self._changed:
            self._has_left = True
            self._changed.notify_all()

    def finish(self) -> None:
        """Say that the match is over; whoever runs the agent calls it."""
        with self._changed:
            self._is_over = True
            self._changed.notify_all()

    def play(self, address: str, token: str) -> None:
        """Play the match at a server with this seat's agent; for a thread of its own."""
        from wildscav.sdk.run import play

        try:
            play(self.agent, address, token)
        finally:
            self.finish()

    def begin(self, match: MatchInfo) -> None:
        """Get ready for a match; for the agent."""
        with self._changed:
            self._player = Player(match, self._names)

    def answer(self, observation: Observation) -> Action:
        """Return what to do in a step, perhaps after waiting for a call; for the agent."""
        with self._changed:
            player = self._begun(0.0)
            player.see(observation)
            while not self._has_left:
                action = player.action()
                if action is not None:
                    return action
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._has_left or not player.wants_call)
            return Action()

    def _begun(self, timeout: float) -> Player:
        """Return the player, as soon as it has seen something or cannot any more."""
        self._changed.wait_for(lambda: self.is_over or self._has_begun(), timeout)
        if self._player is None or (timeout and not self._has_begun()):
            raise TimeoutError("the match has not begun")
        return self._player

    def _begun_within(self, timeout: float | None) -> tuple[Player, float | None]:
        """Return the player, and how many seconds of a timeout are left when the match has begun."""
        began = time.monotonic()
        player = self._begun(START_TIME if timeout is None else timeout)
        return player, None if timeout is None else timeout - (time.monotonic() - began)

    def _has_begun(self) -> bool:
        return self._player is not None and self._player.has_seen

    def _reply(self, player: Player, timeout: float | None) -> Reply:
        self._changed.wait_for(lambda: self.is_over or player.wants_call, timeout)
        if self.is_over:
            return Reply("The match is over.", Reason.MATCH_OVER, 0, over=True)
        if not player.wants_call:
            return Reply("The tool goes on: wait for its end.", Reason.PLAYING, player.steps, over=False)
        return player.reply
