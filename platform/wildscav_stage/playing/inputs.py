"""What a person's page sends, and how it becomes actions."""

from typing import TYPE_CHECKING, Annotated, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, create_model

from wildscav.agent import Action
from wildscav.errors import WildscavError
from wildscav.policy.keys import AT_ONCE, FLAGS, Mouse, held_action

MAX_TURN = 3600.0  # degrees in one message
LONGEST_TEXT = 100  # characters
MAX_ROBOTS = 999  # of a match with a person; a table may allow fewer
Share = Annotated[float, Field(ge=-1.0, le=1.0)]
Turn = Annotated[float, Field(ge=-MAX_TURN, le=MAX_TURN)]
Text = Annotated[str, Field(max_length=LONGEST_TEXT)]
Count = Annotated[int, Field(ge=0, le=2**53)]


class InputError(WildscavError):
    """A message from a page is none of those that a page may send."""


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class Held(_Message):
    """What a person holds of ``FLAGS``, and how far the view was turned since the last message."""

    kind: Literal["input"]
    number: Count  # of the message, from 1 up
    forward: Share = 0.0  # of the full speed; negative walks backward
    right: Share = 0.0
    turn: Turn = 0.0  # degrees; positive turns right
    look: Turn = 0.0  # degrees; positive looks down


if TYPE_CHECKING:
    Input = Held
else:
    Input = create_model("Input", __base__=Held, **dict.fromkeys(FLAGS, (bool, False)))


class Seen(_Message):
    """The number of the last message about the match that the page has received."""

    kind: Literal["seen"]
    number: Count


class Start(_Message):
    """Start a match."""

    kind: Literal["start"]


class Pause(_Message):
    """Pause the match, or go on."""

    kind: Literal["pause"]
    paused: bool


class Rename(_Message):
    """Call the person by another name."""

    kind: Literal["rename"]
    name: Text


class Free(_Message):
    """Free a guest's seat for somebody else."""

    kind: Literal["free"]
    seat: Count


class OpenRoom(_Message):
    """Let guests in by another code, or by none."""

    kind: Literal["room"]
    open: bool


class Ready(_Message):
    """Say whether the person wants the next match to start."""

    kind: Literal["ready"]
    ready: bool


class Arrange(_Message):
    """Choose what the next matches are."""

    kind: Literal["arrange"]
    robots: Annotated[tuple[Text, ...], Field(max_length=MAX_ROBOTS)]
    new_map: bool


Command = Start | Pause | Rename | Free | OpenRoom | Ready | Arrange
Message = Input | Seen | Command
_messages: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="kind")])
_of_spectators: TypeAdapter[Seen] = TypeAdapter(Seen)
T = TypeVar("T")


def decode_message(text: str) -> Message:
    """Return the message in a text from the page of a person who plays.

    Raises:
        InputError: It is none.
    """
    return _decoded(_messages, text)


def decode_of_spectator(text: str) -> Seen:
    """Return the message in a text from a spectator's page.

    Raises:
        InputError: It is none; spectators do nothing else.
    """
    return _decoded(_of_spectators, text)


def _decoded(messages: TypeAdapter[T], text: str) -> T:
    try:
        return messages.validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(map(str, first["loc"])) or "message"
        raise InputError(f"{where}: {first['msg']}") from None


class Controls:
    """Collects a person's inputs until the next step takes them."""

    def __init__(self) -> None:
        self.release()

    @property
    def received(self) -> int:
        """Number of the last input that was received; 0 after a release."""
        return self._held.number

    def release(self) -> None:
        """Let go of everything, and forget the numbers of inputs: another page counts anew."""
        self.taken = 0  # number of the last input that the present frame tells of
        self._taking = 0  # and of the last one that a step has taken
        # Degrees, right and down, of both that the body has yet to turn.
        self.ahead = 0.0, 0.0
        self._left = 0.0, 0.0
        self._held = Input(kind="input", number=0)
        self._turn, self._look = Mouse(), Mouse()
        self._flags = dict.fromkeys(FLAGS, False)

    def receive(self, message: Input) -> None:
        """Note an input. What was pressed since the last step counts even if it is released by now."""
        self._held = message
        self._turn.move(message.turn)
        self._look.move(message.look)
        for name in FLAGS:
            self._flags[name] |= getattr(message, name)

    def take(self, yaw: float, frames: int, turn_speed: float = AT_ONCE) -> Action:
        """Return the action of the next step, which spreads turns over its frames.

        The person looks at ``yaw`` degrees, and turns by ``turn_speed`` degrees/s at most.
        """
        held = self._held
        mouse = self._turn.take(turn_speed, frames), self._look.take(turn_speed, frames)
        action = held_action((held.forward, held.right), mouse, self._flags, yaw, frames)
        self._taking = max(self._taking, held.number)
        self._left = round(self._turn.left, 2), round(self._look.left, 2)
        self._flags = {name: getattr(held, name) for name in FLAGS}
        return action

    def confirm(self) -> None:
        """Note that the step which took the last inputs was played."""
        self.taken = self._taking
        self.ahead = self._left
