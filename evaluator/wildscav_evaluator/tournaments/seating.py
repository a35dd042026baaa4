"""Who sits where: everyone has every seat equally often, and repeated games cancel the luck of the start."""

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.meetings import even_out

Int = NDArray[np.int64]

NONE = -1


def seat_games(games: Int, repeats: int, draws: Draws) -> Int:
    """Return who sits where in every repeat of games (G, P), as an array (G, Q, P) of entrants.

    In repeat k everybody sits k P / Q seats further (rounded down), around the table. If Q divides P, the
    seats of an entrant differ by at most one match over all games; else the seats of the first of the repeats
    do.
    """
    places = games.shape[1]
    first = _spread_evenly(games, places // repeats if places % repeats == 0 else places, draws)
    return np.stack([np.roll(first, repeat * places // repeats, axis=1) for repeat in range(repeats)], axis=1)


def seat_teammates(games: Int, team_size: int, repeats: int, draws: Draws) -> Int:
    """Return who sits where, (G, Q, P), if each P / S seats in a row are a team of different entrants.

    Teammates stay together in all repeats of a game. From one repeat to the next the teams change their
    places, and when each team has had its places, the players of a team do.
    """
    count, places = games.shape
    teams = places // team_size
    turns = min(repeats, teams)  # of the teams
    shifts = -(-repeats // turns)  # of the players of a team
    members = _mix_teams(games, team_size, draws) if teams > 1 else games[:, None, :]
    inside = _spread_evenly(
        members.reshape(count * teams, team_size),
        team_size // shifts if team_size % shifts == 0 else team_size,
        draws,
    )
    first = _place_teams(inside.reshape(count, teams, team_size), turns, draws)
    seated = [
        np.roll(
            first,
            (repeat % turns * teams // turns, repeat // turns * team_size // shifts),
            axis=(1, 2),
        ).reshape(count, places)
        for repeat in range(repeats)
    ]
    return np.stack(seated, axis=1)


def _mix_teams(games: Int, team_size: int, draws: Draws) -> Int:
    """Return the games as teams (G, T, S) in which all pairs are teammates about equally often."""
    count, places = games.shape
    return even_out(games.reshape(count, places // team_size, team_size), range(int(games.max()) + 1), draws)


def _place_teams(teams: Int, turns: int, draws: Draws) -> Int:
    """Order the teams (G, T, S) of each game so that everyone is in every team about equally often."""
    count = teams.shape[1]
    kinds = count // turns if count % turns == 0 else count  # places that are not exchanged in the repeats
    if kinds == 1:
        return teams
    used = np.zeros((int(teams.max()) + 1, kinds), np.int64)
    kind = np.arange(count) % kinds
    placed = np.empty_like(teams)
    for number, game in enumerate(teams[:, draws.order(count)]):
        so_far = used[game].sum(axis=1)  # (T, kinds)
        # Shift all teams of the game together to where they have been least often.
        cost = [int(so_far[np.arange(count), np.roll(kind, shift)].sum()) for shift in range(count)]
        shift = int(np.argmin(cost))
        used[game, np.roll(kind, shift)[:, None]] += 1
        placed[number] = np.roll(game, -shift, axis=0)
    return placed


def _spread_evenly(games: Int, kinds: int, draws: Draws) -> Int:
    """Order the entrants of games (G, P) so that each is at all kinds of seats equally often, up to one game.

    Seats s and s + `kinds` are of the same kind; P is a multiple of `kinds`. An entrant's part in a game is
    an edge between the two, and the kind of seat is its colour. Every `kinds` games of an entrant are a node
    of their own.
    """
    count, places = games.shape
    if kinds == 1:
        return games
    slots = np.arange(places) // kinds  # a game of more seats than kinds is several nodes
    game_nodes = (np.arange(count)[:, None] * (places // kinds) + slots).reshape(-1)
    entrants = games.reshape(-1)
    entrant_nodes = _numbered(entrants, kinds)
    colours = colour_edges(game_nodes, entrant_nodes, kinds)
    kind = draws.order(kinds)[colours].reshape(count, places)
    seated = np.empty_like(games)
    np.put_along_axis(seated, kind + slots * kinds, games, axis=1)
    return seated


def _numbered(entrants: Int, size: int) -> Int:
    """Return a number for each `size` consecutive occurrences of an entrant."""
    order = np.argsort(entrants, kind="stable")
    starts = np.flatnonzero(np.diff(entrants[order], prepend=-1))
    occurrence = np.arange(len(entrants)) - np.repeat(starts, np.diff(np.append(starts, len(entrants))))
    _, nodes = np.unique(entrants[order] * len(entrants) + occurrence // size, return_inverse=True)
    numbered = np.empty_like(entrants)
    numbered[order] = nodes
    return numbered


def colour_edges(left: Int, right: Int, colours: int) -> Int:
    """Return a colour for each edge (E,), so that no two edges of a node have the same.

    D. König, "Über Graphen und ihre Anwendung auf Determinantentheorie und Mengenlehre", 1916.

    Args:
        left: (E,) the node at one end of each edge.
        right: (E,) the node at the other, numbered separately.
        colours: At least the number of edges of any node.
    """
    offset = int(left.max()) + 1
    ends = list(zip(left.tolist(), (right + offset).tolist(), strict=True))
    edges = [[NONE] * colours for _ in range(offset + int(right.max()) + 1)]  # of each colour, by node
    painted = [NONE] * len(ends)

    def paint(edge: int, colour: int) -> None:
        painted[edge] = colour
        for end in ends[edge]:
            edges[end][colour] = edge

    for edge, (here, there) in enumerate(ends):
        free, spare = edges[here].index(NONE), edges[there].index(NONE)
        # Exchange both colours on the path of edges that have them in turn, so that the first is free there.
        path, node, colour = [], there, free
        while (following := edges[node][colour]) != NONE:
            path.append(following)
            node, colour = sum(ends[following]) - node, free + spare - colour
        for old in path:
            for end in ends[old]:
                edges[end][painted[old]] = NONE
        for old in path:
            paint(old, free + spare - painted[old])
        paint(edge, free)
    return np.array(painted, np.int64)
