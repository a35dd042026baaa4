"""Who plays a seat by tools: takes in what it senses, plays the running tool, and replies at its end."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from wildscav.agent import Action, MatchInfo, Observation
from wildscav.words import Reply
from wildscav_language.body import Body
from wildscav_language.calls import Reason, RefusedCallError, Steps, Tool
from wildscav_language.perception import describe
from wildscav_language.tools import tools_of

REFUSAL_TIME = 0.5  # s of game time that a bad call costs
SHOWN = 40  # characters of a tool's name that an answer repeats


@dataclass(slots=True)
class Counts:
    """What a seat's calls come to."""

    calls: int = 0
    refused: int = 0  # calls that could not be understood or played: the losses by parsing
    steps: int = 0  # of game time
    texts: int = 0
    bytes: int = 0  # of all texts
    longest: int = 0  # bytes of the longest text
    ended: Counter[Reason] = field(default_factory=Counter)

    @property
    def decisions(self) -> int:
        """Calls that were played."""
        return self.calls - self.refused


class Player:
    """Plays one seat of one match, a tool at a time."""

    def __init__(self, match: MatchInfo, names: Sequence[str] = ()) -> None:
        """Begin before the first observation."""
        self.match = match
        self.body = Body(match, names)
        self.tools: tuple[Tool, ...] = tools_of(self.body)
        self.counts = Counts()
        self.steps = 0  # that the running tool has played
        self.reply = Reply("", Reason.DONE, 0, over=False)  # to the last call
        self._running: tuple[str, Steps] | None = None

    @property
    def has_seen(self) -> bool:
        """Whether there was an observation."""
        return self.body.has_seen

    @property
    def wants_call(self) -> bool:
        """Whether no tool is running."""
        return self._running is None

    def see(self, observation: Observation) -> None:
        """Take in an observation. Then ask for the ``action``, until there is one."""
        self.body.look(observation)

    def text(self) -> str:
        """Return the text of now. The next one tells what has changed since."""
        text = describe(self.body)
        size = len(text.encode())
        self.counts.texts += 1
        self.counts.bytes += size
        self.counts.longest = max(self.counts.longest, size)
        return text

    def give(self, name: str, arguments: Mapping[str, Any]) -> None:
        """Begin a tool; a bad call begins a pause."""
        self.counts.calls += 1
        self.steps = 0
        try:
            steps = self._tool(name).begin(self.body, arguments)
            self._running = name, steps if self.body.now.alive else self.body.waiting_for_life()
        except RefusedCallError as error:
            self._refuse(name, str(error))

    def action(self) -> Action | None:
        """Return the action of the running tool for this step, or None if a call is wanted."""
        while self._running is not None:
            name, steps = self._running
            if self.steps and self.body.has_just_died:
                self._end(name, Reason.DIED, "")
                break
            try:
                action = next(steps)
            except StopIteration as end:
                self._end(name, *end.value)
            except RefusedCallError as error:
                self._refuse(name, str(error))
            else:
                self.steps += 1
                self.counts.steps += 1
                return action
        return None

    def _tool(self, name: str) -> Tool:
        for tool in self.tools:
            if tool.name == name:
                return tool
        known = ", ".join(tool.name for tool in self.tools)
        raise RefusedCallError(f"There is no tool {name[:SHOWN]!r} here; the tools are {known}.")

    def _refuse(self, name: str, sentence: str) -> None:
        self.counts.refused += 1
        self._running = name, self.body.pause(REFUSAL_TIME, Reason.REFUSED, sentence)

    def _end(self, name: str, reason: Reason, sentence: str) -> None:
        """End the running tool; each call takes a step at least."""
        if self.steps == 0:
            self._running = name, self.body.pause(0.0, reason, sentence)
            return
        self._running = None
        self.counts.ended[reason] += 1
        seconds = self.steps * self.match.step_time
        first = f"{name[:SHOWN]} ended after {seconds:.1f} s: {reason.value}. {sentence}".rstrip()
        self.reply = Reply(f"{first}\n\n{self.text()}", reason, self.steps, over=False)
