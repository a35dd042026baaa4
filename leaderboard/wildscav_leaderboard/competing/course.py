"""The course of a submission: its states as they follow each other, and why it failed."""

from typing import TYPE_CHECKING

from rich.console import Group
from rich.text import Text

from wildscav.errors import UserError
from wildscav.terminal.console import console, console_above, error_console, printable, telling
from wildscav_leaderboard.competing import texts

if TYPE_CHECKING:
    from wildscav_leaderboard.api.documents import SubmissionView, TransitionView
    from wildscav_leaderboard.competing.season_client import SeasonClient

FAULTS = {"agent": "the agent's", "platform": "the platform's; it is not charged"}


def waited(client: "SeasonClient", one: "SubmissionView") -> "SubmissionView":
    """Show the states of a submission as they follow each other, and return the last one."""
    from wildscav_leaderboard.competing.season_client import follow

    shown = 0
    try:
        with telling() as tell:
            for seen in follow(client, one):
                if isinstance(seen, UserError):
                    tell(f"{seen}; asking again")
                    continue
                one = seen
                for entry in one.history[shown:]:
                    console_above(error_console).print(step(entry))
                shown = max(shown, len(one.history))
                tell(f"{one.state} {texts.waiting(one)}")
    except KeyboardInterrupt:
        error_console.print(
            f"It was sent, and goes on without you: wildscav team submissions {one.id} --wait"
        )
        raise
    return one


def check_end(one: "SubmissionView") -> None:
    """Check that a submission takes part in the end.

    Raises:
        UserError: It does not.
    """
    from wildscav_leaderboard.submissions.states import ACTIVE, FAILED

    if one.state == ACTIVE:
        return
    console.print(failure(one))
    if one.state == FAILED and one.fault in FAULTS:
        raise UserError(f"submission {one.id} failed; the fault is {FAULTS[one.fault]}")
    raise UserError(f"submission {one.id} is {one.state}")


def step(entry: "TransitionView") -> Text:
    """Return a line about a state that a submission came into."""
    line = Text.assemble((texts.moment(entry.at), "dim"), " ", texts.state(entry.state))
    return line.append(printable(f"  {entry.detail}" if entry.detail else ""))


def failure(one: "SubmissionView") -> Group:
    """Return what is to be known of a failure: whose fault, the last lines, and how to see it again.

    What happened stands in the submission's history.
    """
    fault = "" if one.fault is None else FAULTS.get(one.fault, one.fault)
    told = any(one.reason == entry.detail for entry in one.history)
    rows = {"fault": fault, "reason": "" if told else one.reason or "", "see it here": one.command or ""}
    parts = [texts.facts(rows)] if any(rows.values()) else []
    if one.last_lines:
        lines = "\n".join(printable(line, "\t") for line in one.last_lines)
        return Group(*parts, Text("last lines of its output:", "dim"), Text(lines))
    return Group(*parts)
