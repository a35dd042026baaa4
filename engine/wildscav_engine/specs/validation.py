"""One-line descriptions of validation errors, and suggestions for names that do not exist."""

from collections.abc import Iterable
from difflib import get_close_matches
from typing import TYPE_CHECKING

from pydantic import ValidationError

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

MAX_EXAMINED = 1000  # errors of one value; if there are more, only their number is reported
MAX_SHOWN = 8  # errors in the line
MAX_CHARACTERS = 100  # of a field's name and of a value


def one_line(error: ValidationError) -> str:
    """Describe in one line what is wrong with a value: each invalid field, the error and the given value."""
    # A value that an adversary wrote may have as many errors as fit into memory.
    if error.error_count() > MAX_EXAMINED:
        return f"{error.error_count():,} of its values are invalid"
    errors = error.errors(include_url=False)
    parts = [_description(detail) for detail in errors[:MAX_SHOWN]]
    if len(errors) > MAX_SHOWN:
        parts.append(f"and {len(errors) - MAX_SHOWN:,} more errors")
    return "; ".join(parts)


def _description(detail: "ErrorDetails") -> str:
    """Describe one error: the field, the message and the given value."""
    place, message = detail["loc"], detail["msg"].removeprefix("Value error, ")
    last = place[-1] if place else ""
    if detail["type"] == "missing" and isinstance(last, int):  # of an array that is too short
        place = place[:-1]
        message = f"must have at least {last + 1} values, not {_shortened_repr(detail['input'])}"
    elif message.startswith(f"{last} is "):  # its validator has named the field
        place = place[:-1]
    field = ".".join(_shortened(str(part)) for part in place)
    if detail["type"] not in {"missing", "extra_forbidden", "value_error"}:
        message += f", not {_shortened_repr(detail['input'])}"
    return f"{field}: {message}" if field else message


def _shortened_repr(value: object) -> str:
    try:
        return _shortened(repr(value))
    except (RecursionError, ValueError):  # nested too deeply, or an integer of thousands of digits
        return f"this {type(value).__name__}"


def _shortened(text: str) -> str:
    return text if len(text) <= MAX_CHARACTERS else f"{text[:MAX_CHARACTERS]}…"


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a suggestion to append to an error, such as " (did you mean 'target'?)", or nothing."""
    near = get_close_matches(name, known, n=2, cutoff=0.7)
    return f" (did you mean {' or '.join(map(repr, near))}?)" if near else ""
