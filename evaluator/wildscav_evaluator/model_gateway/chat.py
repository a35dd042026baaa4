"""What a seat may ask, and what is passed on of the model's answer: named fields of OpenAI's chat protocol.

Fields without a name here are left out, among them ``user``, ``metadata`` and ``store``. Whatever the
model's server would have to fetch for a seat is refused: pictures by their addresses, and schemas elsewhere.
"""

import base64
import binascii
import re
from io import BytesIO
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    JsonValue,
    ValidationError,
)
from pydantic_core import to_json

from wildscav.harness.answers import estimated_tokens
from wildscav_engine.specs.validation import one_line

DATA = re.compile(r"data:image/(png|jpeg);base64,([A-Za-z0-9+/]+={0,2})")
LARGEST_SIDE = 4096  # pixels of a picture
REFERENCES = frozenset(("$ref", "$dynamicRef", "$recursiveRef"))  # of JSON Schema
LARGEST_SCHEMA = 64 << 10  # bytes
MOST_MARKS = 100_000  # commas and opening brackets of a request, which bound its values
FRAME = 1000  # tokens that a server may add to a prompt by its template

Text = Annotated[str, Field(max_length=8 << 20)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]{1,64}$")]


def _is_data(url: str) -> str:
    """Refuse a picture that is no small PNG or JPEG in the request itself."""
    from PIL import Image

    found = DATA.fullmatch(url)
    if found is None:
        raise ValueError(
            "a picture must be in the request itself: data:image/png;base64,… or data:image/jpeg;base64,…"
        )
    try:
        content = BytesIO(base64.b64decode(found[2], validate=True))
        with Image.open(content, formats=["PNG", "JPEG"]) as picture:
            sides = picture.size
    except (OSError, binascii.Error, ValueError, SyntaxError, Warning, Image.DecompressionBombError):
        raise ValueError("a picture is neither a PNG nor a JPEG") from None
    if max(sides) > LARGEST_SIDE:
        raise ValueError(f"a picture has a side of {max(sides):,} pixels, may have {LARGEST_SIDE:,}")
    return url


def _is_small_and_whole(schema: dict[str, JsonValue]) -> dict[str, JsonValue]:
    """Refuse a schema that is large, or refers to another document, which somebody would have to fetch."""
    if len(to_json(schema)) > LARGEST_SCHEMA:
        raise ValueError(f"a schema may have {LARGEST_SCHEMA:,} bytes")
    waiting: list[Any] = [schema]
    while waiting:
        part = waiting.pop()
        if isinstance(part, dict):
            for name in REFERENCES & part.keys():
                if isinstance(part[name], str) and not part[name].startswith("#"):
                    raise ValueError(f"{name} leads out of the schema: only #/… is passed on")
            waiting += part.values()
        elif isinstance(part, list):
            waiting += part
    return schema


Schema = Annotated[dict[str, JsonValue], AfterValidator(_is_small_and_whole)]


class Part(BaseModel):
    """Base of the parts of a request; fields without a name here are left out."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class TextPart(Part):
    """A text among the parts of a message."""

    type: Literal["text"]
    text: Text


class ImageUrl(Part):
    """Where a picture is: in the request itself."""

    url: Annotated[str, AfterValidator(_is_data)]
    detail: Literal["auto", "low", "high"] = "auto"


class ImagePart(Part):
    """A picture among the parts of a message."""

    type: Literal["image_url"]
    image_url: ImageUrl


ContentPart = Annotated[TextPart | ImagePart, Field(discriminator="type")]


class FunctionCall(Part):
    """What a model calls, with arguments as JSON that it wrote itself."""

    name: Annotated[str, Field(max_length=200)]
    arguments: Text


class ToolCall(Part):
    """One call of a message."""

    id: Annotated[str, Field(max_length=200)] = ""
    type: Literal["function"] = "function"
    function: FunctionCall


class Message(Part):
    """One message of a conversation."""

    role: Literal["system", "developer", "user", "assistant", "tool"]
    content: Text | Annotated[list[ContentPart], Field(max_length=2000)] | None = None
    name: Name | None = None
    tool_calls: Annotated[list[ToolCall], Field(max_length=128)] | None = None
    tool_call_id: Annotated[str, Field(max_length=200)] | None = None
    reasoning_content: Text | None = None


class Function(Part):
    """A function that a model may call."""

    name: Name
    description: Text | None = None
    parameters: Schema | None = None
    strict: bool | None = None


class Tool(Part):
    """A tool that a model may use."""

    type: Literal["function"]
    function: Function


class NamedFunction(Part):
    """The name of a function."""

    name: Name


class NamedTool(Part):
    """The tool that the model must use."""

    type: Literal["function"]
    function: NamedFunction


class ChatRequest(Part):
    """A request for an answer."""

    messages: Annotated[list[Message], Field(min_length=1, max_length=2000)]
    tools: Annotated[list[Tool], Field(max_length=128)] | None = None
    tool_choice: Literal["none", "auto", "required"] | NamedTool | None = None
    parallel_tool_calls: bool | None = None
    temperature: Annotated[float, Field(ge=0.0, le=2.0)] | None = None
    top_p: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    presence_penalty: Annotated[float, Field(ge=-2.0, le=2.0)] | None = None
    frequency_penalty: Annotated[float, Field(ge=-2.0, le=2.0)] | None = None
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = None
    stop: Text | Annotated[list[Text], Field(max_length=4)] | None = None
    response_format: Schema | None = None
    reasoning_effort: Annotated[str, Field(pattern=r"^[a-z]{1,16}$")] | None = None
    max_tokens: Annotated[int, Field(ge=1)] | None = None
    max_completion_tokens: Annotated[int, Field(ge=1)] | None = None
    stream: bool = False

    @property
    def most(self) -> int | None:
        """How many tokens the answer may have, if the seat says so."""
        asked = [one for one in (self.max_tokens, self.max_completion_tokens) if one is not None]
        return min(asked, default=None)

    def passed_on(self) -> dict[str, Any]:
        """Return the fields that the model's server gets of it."""
        left_out = {"max_tokens", "max_completion_tokens", "stream"}
        return self.model_dump(mode="json", exclude_unset=True, exclude=left_out)


class ChatError(Exception):
    """A request or an answer is not of the protocol. The message is one line."""


def read_request(content: bytes) -> ChatRequest:
    """Return a seat's request.

    Raises:
        ChatError: It is not valid, or asks for what is not passed on.
    """
    if sum(content.count(mark) for mark in (b",", b"[", b"{")) > MOST_MARKS:
        raise ChatError(f"a request may have {MOST_MARKS:,} commas and opening brackets")
    try:
        request = ChatRequest.model_validate_json(content)
    except ValidationError as error:
        raise ChatError(one_line(error)[:500]) from None
    if request.stream:
        raise ChatError("stream is true: answers come in one piece here, so leave it out")
    return request


class AnswerMessage(Part):
    """The message of an answer."""

    content: str | None = None
    reasoning_content: str | None = None
    refusal: str | None = None
    tool_calls: list[ToolCall] | None = None


class Choice(Part):
    """One answer; no more than one is asked for."""

    message: AnswerMessage
    finish_reason: str | None = None


class ChatAnswer(Part):
    """What a model's server answers."""

    choices: Annotated[list[Choice], Field(min_length=1)]
    usage: Any = None

    def tokens(self, estimated: int, size: int, most: int) -> tuple[int, int]:
        """Return the tokens of the prompt and of the answer: reported ones, or estimates if those cannot be.

        Args:
            estimated: The tokens of the request.
            size: The bytes of it.
            most: The tokens that the answer was allowed.
        """
        usage = self.usage if isinstance(self.usage, dict) else {}
        prompt, answer = usage.get("prompt_tokens"), usage.get("completion_tokens")
        if type(prompt) is not int or not 0 <= prompt <= size + FRAME:
            prompt = estimated
        if type(answer) is not int or not 0 <= answer <= most:
            answer = min(most, estimated_tokens(self.choices[0].message.model_dump(exclude_none=True)))
        return prompt, answer


def read_answer(content: bytes) -> ChatAnswer:
    """Return the answer of a model's server.

    Raises:
        ChatError: It is not of the protocol.
    """
    try:
        return ChatAnswer.model_validate_json(content)
    except ValidationError as error:
        raise ChatError(f"its answer is not of the protocol: {one_line(error)[:200]}") from None
