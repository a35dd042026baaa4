"""A language model plays a seat of words.

    from wildscav.harness.player import ModelPlayer
    from wildscav.harness.settings import ModelSettings

    course = ModelPlayer(seat, ModelSettings(url="http://127.0.0.1:8000/v1")).play()
    print(course.ending, course.spending)

``seat`` is a ``wildscav.words.WordsSeat``; or a ``wildscav_language.seat.Seat``, with the rules besides.
"""

from dataclasses import asdict
from typing import Any, NamedTuple

from wildscav.errors import AgentError
from wildscav.harness.answers import QUOTA, Answer, ModelError
from wildscav.harness.conversation import NOTE, Conversation, Exchange, tools_of
from wildscav.harness.log import Log
from wildscav.harness.server import ModelServer
from wildscav.harness.settings import ModelSettings
from wildscav.harness.spending import Ending, Spending
from wildscav.notes import say

COST = 0.5  # s of game time for an answer without a call that can be played
REST = 60.0  # s that a seat stands at a time whose model plays no more
TOO_LONG = (400, 413, 422)  # answers of servers to prompts that are too long, among others
REMINDER = (
    "Your answer had no call of a tool. Answer with one. Each further answer without a call that can be "
    f"played costs {COST:g} s of game time, in which you stand still."
)
CHARGED = f"Your answer had no call that could be played, so {COST:g} s have passed. Call one tool."
BROKEN = "Nothing was played: the arguments of your call are not a JSON object."
SECOND = "This call was not played: of several calls in one answer, only the first is."
NOTED, NO_NOTE = "Noted.", "A note has a text."


class Course(NamedTuple):
    """How a model's play went."""

    ending: Ending  # why it ended
    detail: str  # what its server said last, if that ended it
    spending: Spending  # what it took


class ModelPlayer:
    """A model at a seat, for one match.

    Args:
        seat: The seat.
        settings: The model, and what it may spend.
        rules: Of the match; by default, those that the seat tells.

    Raises:
        UserError: The address is not valid.
    """

    def __init__(self, seat: Any, settings: ModelSettings, rules: str | None = None) -> None:
        self._seat, self._settings = seat, settings
        self._rules: str = seat.rules if rules is None else rules
        self.spending = Spending()
        self._log = Log(settings.log, settings.key)
        self._server = ModelServer(settings, self.spending, self._log)
        self._idle = 0  # answers in a row of which nothing was played

    def play(self) -> Course:
        """Play to the end of the match. A seat whose model plays no more stands still to that end."""
        self._tools = tools_of(self._seat.tools)
        self._conversation = Conversation(self._rules, self._seat.observe(), COST, self._settings)
        ending, detail = Ending.MATCH_OVER, ""
        try:
            while not self._seat.is_over:
                if (spent := self.spending.ending(self._settings)) is not None:
                    ending = spent
                    break
                self._turn()
        except ModelError as error:
            ending, detail = self._ending_of(error), str(error)
        finally:
            self._server.close()
        self._log.ended(ending, {"detail": detail, **asdict(self.spending)})
        if ending != Ending.MATCH_OVER:
            say(f"The model plays no more: {ending}. {detail}".strip())
        while not self._seat.is_over:
            self._seat.call("wait_until", {"seconds": REST})
        return Course(ending, detail, self.spending)

    def _ending_of(self, error: ModelError) -> Ending:
        """Return the ending after a request that was not answered."""
        if (spent := self.spending.ending(self._settings)) is not None:
            return spent
        if error.code == QUOTA:
            return Ending.OUT_OF_QUOTA
        return Ending.MODEL_FAILED if error.may_pass else Ending.REQUEST_REFUSED

    def _turn(self) -> None:
        """Ask the model once, and play its answer."""
        answer = self._ask()
        if answer.text:
            say(answer.text)
        results, now = self._play_calls(answer)
        if now:
            self._idle, line = 0, _line(answer, now)
        else:
            line = f"- no call: {answer.text}"
            told, now = self._charge()
            results = [*results[:-1], f"{results[-1]}\n{told}"] if results else [told]
        self._conversation.add(Exchange(answer, tuple(results), now, line))

    def _ask(self) -> Answer:
        """Return the model's answer; a conversation that is too long for it is shortened."""
        settings = self._settings
        picture = self._seat.picture(marks=settings.marks) if settings.pictures else None
        while True:
            try:
                return self._server.ask(self._conversation.messages(picture), self._tools)
            except ModelError as error:
                if error.status not in TOO_LONG or not self._conversation.shorten():
                    raise

    def _play_calls(self, answer: Answer) -> tuple[list[str], str]:
        """Play the first call, and keep all notes.

        Returns:
            What comes of each call, and the text of the seat after it; "" if nothing was played.
        """
        results, now, is_first = [], "", True
        for call in answer.calls:
            if call.name == NOTE:
                text = (call.arguments or {}).get("text")
                is_note = isinstance(text, str) and bool(text)
                results.append(NOTED if is_note else NO_NOTE)
                self._conversation.note(str(text) if is_note else "")
                continue
            if not is_first:
                results.append(SECOND)
                continue
            is_first, broken = False, BROKEN
            if call.arguments is not None:
                try:
                    now = self._seat.call(call.name, call.arguments).text
                    self.spending.calls += 1
                except (AgentError, RecursionError) as error:
                    broken = f"Nothing was played: {error}."
            results.append(now or broken)
        return results, now

    def _charge(self) -> tuple[str, str]:
        """Remind of what an answer needs, or let it cost time.

        Returns:
            What the model is told, and the text of the seat after it; "" if no time has passed.
        """
        self._idle += 1
        self.spending.without_call += 1
        if self._idle == 1:
            return REMINDER, ""
        now = self._seat.call("wait_until", {"seconds": COST}).text
        return f"{CHARGED}\n\n{now}", now


def _line(answer: Answer, now: str) -> str:
    """Return what is left of an exchange when it is long ago."""
    call = next(call for call in answer.calls if call.name != NOTE)
    return f"- {call.name} {call.written}: {now.partition(chr(10))[0]}"
