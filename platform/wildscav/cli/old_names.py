"""Names of commands and options of release 0.1. They work for one more release, and print the new names."""

from typing import Any

import typer

# The new words of commands, in the place of the old ones.
COMMANDS = {
    ("audit",): ("verify",),
    ("cancel",): ("team", "submissions", "cancel"),
    ("key",): ("season", "key"),
    ("logout",): ("login", "--logout"),
    ("logs",): ("team", "logs"),
    ("look",): ("map", "look"),
    ("make-maps",): ("map", "make"),
    ("matches",): ("team", "matches"),
    ("replay-agent",): ("verify",),
    ("rescore",): ("verify",),
    ("secret", "check"): ("verify",),
    ("secret",): ("season", "secret"),
    ("submissions",): ("team", "submissions"),
    ("video",): ("replay", "--video"),
}
# The option that takes the second argument of an old command, and the options of that command with a value.
SECOND_ARGUMENT = {
    "replay-agent": ("--agent", ("--seat", "--logs", "--sandbox")),
    "secret check": ("--commitment", ()),
}
# New options for old ones: of one command, or of all that know the new one and not the old one.
OPTIONS = {
    "audit": {"--records": "--download", "--replay": "--resimulate"},
    "video": {"--follow": "--view=behind", "--overview": "--view=above", "--grid": "--view=grid"},
    "replay": {"--follow": "--seat"},
    "play": {"--map": "--map-seed"},
    "": {"--output": "--out", "--jobs": "--workers", "--at-once": "--workers", "--no-open": "--no-browser"},
}


def with_new_names(words: list[str], root: Any, context: Any) -> list[str]:
    """Return the words of a command line with new names in place of old ones, and print what is new."""
    old = next(
        (old for old in sorted(COMMANDS, key=len, reverse=True) if tuple(words[: len(old)]) == old), ()
    )
    if words[0] == "legacy":
        _say("wildscav legacy", "wildscav-legacy")
    name, rest = " ".join(old or words[:1]), words[len(old) :]
    if old:
        _say(f"wildscav {name}", f"wildscav {' '.join(COMMANDS[old])}")
        rest = [*COMMANDS[old], *_with_option(name, rest)]
    new = {**OPTIONS[""], **OPTIONS.get(name, {})}
    if name == "leaderboard":
        rest = [name, *_with_season(rest[1:])]
    # Making a command takes time, and most command lines have no old option.
    if not any(word.partition("=")[0] in new for word in rest):
        return rest
    return _with_new_options(rest, new, _options(rest, root, context))


def _with_option(name: str, words: list[str]) -> list[str]:
    """Return the words after an old command, with an option before a second argument that has become one."""
    option, with_value = SECOND_ARGUMENT.get(name, ("", ()))
    arguments = [
        place
        for place, word in enumerate(words)
        if not word.startswith("-") and (place == 0 or words[place - 1] not in with_value)
    ]
    if not option or len(arguments) < 2:
        return words
    return [*words[: arguments[1]], option, *words[arguments[1] :]]


def _with_season(words: list[str]) -> list[str]:
    """Return the words after ``leaderboard``, where ``--season`` was a switch and an argument the address."""
    if "--season" not in words:
        return words
    place = words.index("--season")
    before, after = words[:place], words[place + 1 :]
    if after and not after[0].startswith("-"):
        return words
    others = before + after
    addresses = [word for word in others if word.startswith(("http://", "https://"))]
    address = addresses[0] if addresses else "latest"
    _say("leaderboard --season", f"leaderboard --season {address}")
    return ["--season", address, *(word for word in others if word != address)]


def _options(words: list[str], root: Any, context: Any) -> set[str]:
    """Return the options of the command that words begin with."""
    command = root
    for word in words:
        if not hasattr(command, "get_command") or (below := command.get_command(context, word)) is None:
            break
        command = below
    return {option for each in command.params for option in (*each.opts, *each.secondary_opts)}


def _with_new_options(words: list[str], new: dict[str, str], known: set[str]) -> list[str]:
    changed = []
    for word in words:
        option, equals, value = word.partition("=")
        other = new.get(option, option)
        if other != option and option not in known and other.partition("=")[0] in known:
            _say(option, other)
            word = other + equals + value  # noqa: PLW2901
        changed.append(word)
    return changed


def _say(old: str, new: str) -> None:
    typer.echo(f"wildscav: `{old}` is called `{new}` now; the old name goes with the next release", err=True)
