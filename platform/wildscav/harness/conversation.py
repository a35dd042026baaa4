"""What a model is shown: its task, what happened last, a line for each answer before that, and its notes."""

import base64
from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

from wildscav.harness.answers import Answer, encodable
from wildscav.harness.settings import ModelSettings

Message: TypeAlias = dict[str, Any]

NOTE = "note"  # the tool by which it writes notes
LONGEST_LINE = 200  # characters of what is left of an answer
TASK = """\
You play one seat of a match in a 3D world by calling tools. Answer every message with one call of a tool. \
What you write beside it is shown to those who watch, so one short sentence of what you intend is welcome.
Of several calls in one answer, the first is played. An answer without a call that can be played costs \
{cost:g} s of game time, after one reminder. Tools end early when something happens that matters, so \
give them enough seconds.
Old messages are shortened to a line each. `note` keeps a note that you see every time, and costs no \
game time: call it beside another tool. Notes have {notes:,} characters; the oldest are dropped.

{rules}"""


class Exchange(NamedTuple):
    """An answer of the model, and what came of it."""

    answer: Answer
    results: tuple[str, ...]  # of each of its calls; of an answer without calls, what it is told
    now: str  # the text of the seat after it; "" if nothing was played
    line: str  # what is left of it later

    def messages(self) -> list[Message]:
        """Return it in the form of the protocol."""
        said: Message = {"role": "assistant", "content": self.answer.text or None}
        if not self.answer.calls:
            told = [{"role": "user", "content": result} for result in self.results]
            return [said | {"content": self.answer.text or "(nothing)"}, *told]
        said["tool_calls"] = [
            {"id": call.id, "type": "function", "function": {"name": call.name, "arguments": call.written}}
            for call in self.answer.calls
        ]
        answered = zip(self.answer.calls, self.results, strict=True)
        told = [{"role": "tool", "tool_call_id": call.id, "content": result} for call, result in answered]
        return [said, *told]


class Conversation:
    """The conversation of one match: its rules, the first text of the seat, and what happens after that.

    ``cost`` is what an answer without a call costs, s of game time.
    """

    def __init__(self, rules: str, first: str, cost: float, settings: ModelSettings) -> None:
        self._settings = settings
        task = TASK.format(cost=cost, notes=settings.notes, rules=rules)
        self._task = f"{task}\n\n{settings.instructions}".rstrip()
        self._opening = first  # the text before the first exchange that is kept
        self._lines: list[str] = []
        self._exchanges: list[Exchange] = []
        self.notes: list[str] = []

    def note(self, text: str) -> None:
        """Keep a note; the oldest are dropped if they are too long together."""
        kept = encodable(text)[: self._settings.notes]
        self.notes += [kept] if kept else []
        while sum(map(len, self.notes)) > self._settings.notes:
            del self.notes[0]

    def add(self, exchange: Exchange) -> None:
        """Add an exchange. If there are too many, half of them are shortened at once.

        So most requests begin as the one before did, and servers need not read that again.
        """
        self._exchanges.append(exchange)
        if len(self._exchanges) > self._settings.window:
            self.shorten()

    def shorten(self) -> bool:
        """Shorten the older half of the exchanges; return whether there was anything to shorten."""
        count = (len(self._exchanges) + 1) // 2
        if not count:
            return False
        old, self._exchanges = self._exchanges[:count], self._exchanges[count:]
        self._opening = next((one.now for one in reversed(old) if one.now), self._opening)
        lines = [" ".join(one.line.split())[:LONGEST_LINE] for one in old]
        self._lines = [*self._lines, *lines][-self._settings.lines or len(self._lines) + count :]
        return True

    def messages(self, picture: bytes | None = None) -> list[Message]:
        """Return the messages of the next request, perhaps with a PNG file of what the seat sees now."""
        before = "\n".join(["What you did before:", *self._lines, "", ""]) if self._lines else ""
        found: list[Message] = [
            {"role": "system", "content": self._task},
            {"role": "user", "content": f"{before}{self._opening}"},
        ]
        for exchange in self._exchanges:
            found += exchange.messages()
        if last := self._last(picture):
            if found[-1]["role"] == "user":  # some servers want no two in a row
                last.insert(0, {"type": "text", "text": found.pop()["content"]})
            plain = last if picture else "\n\n".join(part["text"] for part in last)
            found.append({"role": "user", "content": plain})
        return found

    def _last(self, picture: bytes | None) -> list[dict[str, Any]]:
        """Return the parts of the last message: notes, and what the seat sees."""
        parts: list[dict[str, Any]] = []
        if self.notes:
            parts.append({"type": "text", "text": "\n".join(["Your notes:", *self.notes])})
        if picture is not None:
            data = base64.b64encode(picture).decode()
            parts.append({"type": "text", "text": "This is what you see now."})
            parts.append({"type": "image_url", "image_url": {"url": f"data:image/png;base64,{data}"}})
        return parts


def tools_of(tools: Sequence[Any]) -> list[dict[str, Any]]:
    """Return the tools of a seat, and the one for notes, in the form of the protocol."""
    text = {"type": "string", "description": "what to remember, in a line"}
    schema = {"type": "object", "properties": {"text": text}, "required": ["text"]}
    note = NOTE, "Keep a note that you see every time. It costs no game time.", schema
    all_tools = [*((tool.name, tool.description, tool.schema) for tool in tools), note]
    fields = "name", "description", "parameters"
    return [{"type": "function", "function": dict(zip(fields, tool, strict=True))} for tool in all_tools]
