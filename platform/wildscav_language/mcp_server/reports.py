"""What clients are told of matches, besides what their seats sense."""

from wildscav_engine.simulation.systems.supplies import team_supplies
from wildscav_engine.specs.result import MatchResult
from wildscav_engine.specs.rules import FRAME
from wildscav_language.mcp_server.matches import ClientSeat, ClientsMatch

COUNTED = ("supplies", "kills", "deaths")  # what is told of each seat besides its metrics


def seated(match: ClientsMatch, seat: ClientSeat) -> str:
    """Return what a client is told of the seat that it has taken."""
    clock = match.hosted.clock
    seats = ", ".join(f'{number} "{name}"' for number, name in enumerate(match.hosted.names))
    return (
        f"match: {match.id}\nseat: {seat.handle}\n"
        f"Every call needs this handle of your seat. You have seat {seat.number}; the seats are {seats}.\n"
        f"The match waits for your calls: {clock.answer_limit:g} s for each action, {clock.time_bank:g} s in "
        "all. Read the rules, observe, then act with the other tools."
    )


def state(match: ClientsMatch) -> str:
    """Return a line on a match, with nothing that opens a seat of it."""
    seconds = match.hosted.match.frame * FRAME
    how = "over" if match.result else match.failure or f"played for {seconds:.1f} s of game time"
    free = len(match.free_seats) if match.is_open else 0
    names = ", ".join(f'"{name}"' for name in match.hosted.names)
    joining = f"; {free} free for clients with the join code" if free else ""
    return f"{match.id}: {how}; seats {names}{joining}"


def score(match: ClientsMatch, own: ClientSeat) -> str:
    """Return the score of a match: at its end of all seats, and before what its own observations tell."""
    result, counts = match.result, own.words.counts
    how = f"over, because of {result.ending.replace('_', ' ')}," if result else "not over"
    lines = [f"{match.id}: {how} after {match.hosted.match.frame * FRAME:.1f} s of game time."]
    if result is None:
        lines.append(f"You carry {_carried(match, own)}.")
    else:
        for seat, name in enumerate(match.hosted.names):
            you = " (you)" if seat == own.number else ""
            lines.append(f'seat {seat} "{name}"{you}: {_achieved(match, result, seat)}')
    lines.append(f"Your calls: {counts.calls}, refused: {counts.refused}, steps played: {counts.steps}.")
    return "\n".join(lines)


def _carried(match: ClientsMatch, own: ClientSeat) -> str:
    """Return how many supplies a seat and its team carry."""
    agents, seat = match.hosted.match.state.agents, own.number
    together = team_supplies(agents.team[0], agents.supplies[0], agents.team[0, seat])
    return f"{agents.supplies[0, seat]} supplies, your team {together}"


def _achieved(match: ClientsMatch, result: MatchResult, seat: int) -> str:
    """Return what a seat has achieved."""
    agents = match.hosted.match.state.agents
    counts = {name: float(getattr(agents, name)[0, seat]) for name in COUNTED}
    told = result.seats[seat].metrics | counts
    return ", ".join(f"{name.replace('_', ' ')} {value:.4g}" for name, value in told.items())
