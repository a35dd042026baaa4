"""What a model answers: a text, and calls of tools. Whatever a server sends is read without trust."""

import json
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from wildscav.errors import WildscavError

LARGEST_ANSWER = 8 << 20  # bytes
LONGEST_REASON = 300  # characters of a server's words that are kept
BUSY = (408, 409, 425, 429)  # answers, besides those from 500 on, after which a request is tried again
BYTES_PER_TOKEN = 4  # of JSON, where no server counts
TOKENS_PER_PICTURE = 1_000
MOST_TOKENS = 10**8  # of one request, that a server may claim
MOST_CALLS = 16  # of an answer, that are looked at
LONGEST_ARGUMENTS = 8_000  # characters of JSON
LONGEST_TEXT = 4_000  # characters of a text that are kept
QUOTA = "insufficient_quota"  # the code of servers and gateways whose budget for us is spent
NAME = re.compile(r"[^A-Za-z0-9_-]")  # what no name of a tool may have
ID = re.compile(r"[A-Za-z0-9_-]{1,64}")


class ModelError(WildscavError):
    """A model's server gave no answer. The message is one line.

    Args:
        message: What happened.
        status: Of HTTP; 0 without an answer.
        code: The server's own word for it.
        may_pass: Whether the same request may be answered later.
        after: Seconds to wait before that, if the server told them.
    """

    def __init__(
        self, message: str, status: int = 0, code: str = "", *, may_pass: bool = True, after: float = 0.0
    ) -> None:
        super().__init__(message)
        self.status, self.code, self.may_pass, self.after = status, code, may_pass, after


def refusal(status: int, body: object, retry_after: str | None) -> ModelError:
    """Return the error of an answer with a status of failure, its JSON, and its header ``Retry-After``."""
    body = body.get("error", body) if isinstance(body, dict) else {}
    body = body if isinstance(body, dict) else {"message": body}
    code = str(body.get("code") or body.get("type") or "")
    try:
        after = max(0.0, float(retry_after or 0.0))
    except ValueError:  # a date
        after = 0.0
    said = " ".join(str(body.get("message") or "no reason")[:LONGEST_REASON].split())
    may_pass = (status in BUSY or status >= 500) and code != QUOTA
    return ModelError(f"its server answers {status}: {said}", status, code, may_pass=may_pass, after=after)


class Call(NamedTuple):
    """A call of a tool."""

    id: str
    name: str
    arguments: dict[str, Any] | None  # None if the model wrote no JSON object

    @property
    def written(self) -> str:
        """The arguments as valid JSON, which servers want to get back."""
        return json.dumps(self.arguments or {})


class Answer(NamedTuple):
    """One answer of a model."""

    text: str  # what it says
    calls: tuple[Call, ...]
    prompt_tokens: int
    answer_tokens: int


def read_answer(document: object, prompt: object, number: int) -> Answer:
    """Return the answer in what a server sent.

    The messages and tools of the ``prompt`` serve to estimate tokens that it does not count right; the
    ``number`` of the request gives ids to calls that have none.

    Raises:
        ModelError: There is no answer in it.
    """
    try:
        message: Any = document["choices"][0]["message"]  # type: ignore[index]
    except (TypeError, KeyError, IndexError):
        message = None
    if not isinstance(message, dict):
        raise ModelError("the server's answer has no message in it")
    said = _text(message.get("content")) or _text(message.get("refusal"))
    thought = _text(message.get("reasoning_content")) or _text(message.get("reasoning"))
    calls = _calls(message.get("tool_calls"), number)
    usage = document.get("usage") if isinstance(document, dict) else None
    usage = usage if isinstance(usage, dict) else {}
    prompt_tokens = _tokens(usage.get("prompt_tokens")) or estimated_tokens(prompt)
    answer_tokens = _tokens(usage.get("completion_tokens")) or estimated_tokens(message)
    return Answer((said or thought)[:LONGEST_TEXT], calls, prompt_tokens, answer_tokens)


def estimated_tokens(content: object) -> int:
    """Return about how many tokens some messages, tools or texts have."""
    pictures = 0

    def plain(value: object) -> object:
        nonlocal pictures
        if isinstance(value, Mapping):
            if value.get("type") == "image_url":
                pictures += 1
                return ""
            return {name: plain(one) for name, one in value.items()}
        return [plain(one) for one in value] if isinstance(value, list | tuple) else value

    written = json.dumps(plain(content), ensure_ascii=False).encode("utf-8", "replace")
    return len(written) // BYTES_PER_TOKEN + pictures * TOKENS_PER_PICTURE


def _tokens(count: object) -> int:
    """Return a server's count if it can be true, else 0."""
    return count if type(count) is int and 0 < count <= MOST_TOKENS else 0


def _text(content: object) -> str:
    """Return the text of a content, which may come in parts."""
    if isinstance(content, list):
        parts = [part.get("text") for part in content if isinstance(part, dict)]
        content = "".join(part for part in parts if isinstance(part, str))
    return encodable(content).strip() if isinstance(content, str) else ""


def encodable(text: str) -> str:
    """Return a text without halves of characters, which JSON can have and UTF-8 cannot."""
    return text.encode("utf-8", "replace").decode("utf-8")


def _calls(written: object, number: int) -> tuple[Call, ...]:
    """Return the calls of a message."""
    found: list[Call] = []
    for one in written[:MOST_CALLS] if isinstance(written, list) else []:
        function = one.get("function") if isinstance(one, dict) else None
        if not isinstance(function, dict):
            continue
        name = NAME.sub("_", str(function.get("name")))[:64] or "_"
        given = one.get("id")
        is_fit = isinstance(given, str) and ID.fullmatch(given) and all(given != call.id for call in found)
        # Nine letters and digits, since some servers take no other ids.
        id_kept = given if is_fit else f"c{number % 10**6:06}{len(found):02}"
        found.append(Call(id_kept, name, _arguments(function.get("arguments"))))
    return tuple(found)


def _arguments(written: object) -> dict[str, Any] | None:
    """Return the arguments of a call, or None if they are no JSON object, or too long."""
    try:
        if isinstance(written, str):
            written = json.loads(written or "{}", parse_constant=_refuse)
        is_fit = isinstance(written, dict) and len(json.dumps(written, allow_nan=False)) <= LONGEST_ARGUMENTS
    except (ValueError, RecursionError):
        return None
    return written if is_fit and isinstance(written, dict) else None


def _refuse(constant: str) -> None:
    raise ValueError(f"{constant} is no JSON")
