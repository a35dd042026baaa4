"""The arguments of what organizers can do: forms, API and command line take them by these types."""

from functools import partial
from typing import Annotated, Literal, NamedTuple

from pydantic import AfterValidator, BaseModel, BeforeValidator, Field

from wildscav_leaderboard.accounts.passwords import hashed, new_password
from wildscav_leaderboard.seasons.names import checked_line
from wildscav_leaderboard.seasons.refusals import InvalidError

LONGEST_REASON, LONGEST_TITLE, LONGEST_TEXT = 500, 100, 5000  # characters


class Password(NamedTuple):
    """A password that an account gets."""

    text: str
    secret: str  # what is stored
    is_new: bool  # whether it was made here, and so must be shown


class NewKey(BaseModel):
    """The key of an invitation, which is shown once."""

    key: str


class NewPassword(BaseModel):
    """A password that was made for an account, which is shown once."""

    name: str
    password: str | None  # None if it was given


def _line(what: str, longest: int, text: str) -> str:
    return checked_line(text, what, longest)


def _password(given: str | None) -> Password:
    text = given or new_password()
    return Password(text, hashed(text), is_new=not given)


def _long_text(text: str) -> str:
    text = text.replace("\r\n", "\n").strip()
    if len(text) > LONGEST_TEXT or not all(line.isprintable() for line in text.split("\n")):
        raise InvalidError(f"an announcement may have {LONGEST_TEXT:,} printable characters at most")
    return text


_Reason = Annotated[
    str,
    AfterValidator(partial(_line, "reason", LONGEST_REASON)),
    Field(min_length=1, max_length=LONGEST_REASON, title="Reason"),
]
Reason = Annotated[_Reason, Field(description="Why; everyone sees it.")]
ReasonForOwner = Annotated[_Reason, Field(description="Why; its owner is told.")]
Title = Annotated[
    str,
    AfterValidator(partial(_line, "title of an announcement", LONGEST_TITLE)),
    Field(max_length=LONGEST_TITLE, title="Title", description="The title."),
]
Text = Annotated[
    str, AfterValidator(_long_text), Field(max_length=LONGEST_TEXT, title="Text", description="The text.")
]
Label = Annotated[str, Field(max_length=LONGEST_TITLE, title="For whom", description="For whom it is.")]
Uses = Annotated[
    int | None,
    Field(
        ge=1,
        le=1_000_000,
        title="Registrations",
        description="How many people may register with it; 0 or nothing for any number.",
    ),
]
Days = Annotated[
    int | None,
    Field(ge=1, le=3650, title="Days", description="After how many days it expires; 0 or nothing for never."),
]
Role = Annotated[
    Literal["competitor", "organizer"], Field(title="As", description="For organizers, not competitors.")
]
Track = Annotated[str, Field(max_length=40, title="Track", description="A track, or all.")]
Submissions = Annotated[
    str,
    Field(
        max_length=1000,
        pattern=r"^(all|\d{1,15}( \d{1,15})*)$",
        title="Submissions",
        description='Numbers of submissions, such as "3 17", or all.',
    ),
]
AccountName = Annotated[str, Field(title="Account", description="The name of the account.")]
TeamName = Annotated[str, Field(title="Team", description="A team's name")]
Number = Annotated[int, Field(ge=1, le=2**53, title="Submission", description="a submission's number")]
MatchNumber = Annotated[int, Field(ge=1, le=2**53, title="Match", description="The number of a match.")]
Chosen = Annotated[
    Password,
    BeforeValidator(_password),
    # Excluded: what a person types on a page or sends to the API would be seen by others on the way.
    Field(validate_default=True, exclude=True, description="Its password; a new one is made without it."),
]
