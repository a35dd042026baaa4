"""The texts that people give to accounts, teams and submissions, checked once where they come in."""

import re
import unicodedata

from wildscav_leaderboard.seasons.refusals import InvalidError

NAME = re.compile(r"[a-z0-9][a-z0-9-]{1,39}")
# Letters of other scripts that look like Latin ones, from https://www.unicode.org/Public/security/latest/confusables.txt:
# those of them that keyboards of people have. What nobody sees is left out.
LOOK_ALIKES = str.maketrans(
    "АВЕЅІЈКМНОРСТУХԌаеѕіјорсухһԁԛԝӏѵΑΒΕΖΗΙΚΜΝΟΡΤΥΧαγινορυϲϳՕՍՏԼհոսօցɑɡıſ0|",  # noqa: RUF001
    "ABESIJKMHOPCTYXGaesijopcyxhdqwlvABEZHIKMNOPTYXayivopucjOUSLhnuogagifol",
    "\u034f\u115f\u1160\u17b4\u17b5\u2800\u3164\uffa0",
)


def checked_name(name: str, what: str) -> str:
    """Return a name that may be part of an address.

    Args:
        what: What it names, for the error.

    Raises:
        InvalidError: It is not allowed.
    """
    if NAME.fullmatch(name) is None:
        raise InvalidError(
            f"the {what} {shown(name)} is not allowed: 2 to 40 of a-z, 0-9 and -, a letter or digit first"
        )
    return name


def checked_line(text: str, what: str, longest: int, *, empty: bool = False) -> str:
    """Return a text of one line without spaces around it.

    Args:
        what: What it is, for the error.
        longest: The number of its characters, at most.
        empty: Whether it may be empty.

    Raises:
        InvalidError: It is not allowed.
    """
    text = unicodedata.normalize("NFC", text).strip()
    if not text.isprintable() or len(text) > longest or not (text or empty):
        fewest = 0 if empty else 1
        raise InvalidError(f"the {what} must have {fewest} to {longest} printable characters on one line")
    return text


def skeleton(text: str) -> str:
    """Return what all texts share that look like a text, whatever their case, as UTS 39 compares names."""
    text = unicodedata.normalize("NFKC", text).translate(LOOK_ALIKES).casefold().translate(LOOK_ALIKES)
    text = text.replace("rn", "m").replace("vv", "w").replace("i", "l").replace("1", "l")
    return " ".join(text.split())


def shown(text: str) -> str:
    """Return a text for an error message, shortened and without control characters."""
    return repr(text if len(text) <= 60 else f"{text[:57]}...")
