"""What clients are told of matches, besides what their seats sense."""

from wildscav_engine.specs.rules import FRAME
from wildscav_language.mcp_server.matches import ClientSeat, ClientsMatch

COUNTED = ("supplies", "kills", "deaths")  # what is told of each seat while a match is played


def seated(match: ClientsMatch, seat: ClientSeat) -> str:
    """Return what a client is told of the seat that it has taken."""
    seats = ", ".join(f'{number} "{name}"' for number, name in enumerate(match.hosted.names))
    return (
        f"match: {match.id}\nseat: {seat.handle}\n"
        f"Every call needs this handle of your seat. You have seat {seat.number}; the seats are {seats}.\n"
        "The match waits for your calls: read the rules, observe, then act with the other tools."
    )


def state(match: ClientsMatch) -> str:
    """Return a line on a match, with nothing that opens a seat of it."""
    seconds = match.hosted.match.frame * FRAME
    how = "over" if match.result else match.failure or f"played for {seconds:.1f} s of game time"
    free = sum(not seat.is_taken for seat in match.seats) if match.is_open else 0
    names = ", ".join(f'"{name}"' for name in match.hosted.names)
    joining = f"; {free} free for clients with the join code" if free else ""
    return f"{match.id}: {how}; seats {names}{joining}"


def score(match: ClientsMatch, own: ClientSeat) -> str:
    """Return the score of a match, so far or at its end."""
    result, counts = match.result, own.words.counts
    how = f"over, because of {result.ending.replace('_', ' ')}," if result else "not over"
    lines = [f"{match.id}: {how} after {match.hosted.match.frame * FRAME:.1f} s of game time."]
    for seat, name in enumerate(match.hosted.names):
        you = " (you)" if seat == own.number else ""
        lines.append(f'seat {seat} "{name}"{you}: {_achieved(match, seat)}')
    lines.append(f"Your calls: {counts.calls}, refused: {counts.refused}, steps played: {counts.steps}.")
    return "\n".join(lines)


def _achieved(match: ClientsMatch, seat: int) -> str:
    """Return what a seat has achieved; while it is played, nothing that tells a hidden place."""
    agents = match.hosted.match.state.agents
    counts = {name: float(getattr(agents, name)[0, seat]) for name in COUNTED}
    told = counts if match.result is None else match.result.seats[seat].metrics | counts
    return ", ".join(f"{name.replace('_', ' ')} {value:.4g}" for name, value in told.items())
