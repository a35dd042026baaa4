"""Who sits where: everyone has every seat equally often, and repeated games cancel the luck of the start."""

from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from wildscav_evaluator.tournaments.draws import Draws
from wildscav_evaluator.tournaments.swap_search import search_swaps

Int = NDArray[np.int64]

TEAM_WORK = 4_000_000  # swaps between teams looked at
TEAM_STEPS = 2000  # at most
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
    entrants = int(games.max()) + 1
    start = games.reshape(1, count, places // team_size, team_size).copy()
    width = max(1, min(count // 4, 20_000 // (places * team_size)))
    steps = min(TEAM_STEPS, TEAM_WORK // (width * places * team_size))
    return search_swaps(start, np.eye(entrants, dtype=bool), steps, draws, width)


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
    graph = _Graph(left, right, colours)
    for edge in range(len(left)):
        graph.colour(edge)
    return np.array(graph.colours, np.int64)


class _Graph:
    """A graph whose edges get their colours one after the other.

    The nodes of both sides are numbered together here, in one list, which holds the edge of each colour.
    """

    def __init__(self, left: Int, right: Int, colours: int) -> None:
        offset = int(left.max()) + 1
        nodes = offset + int(right.max()) + 1
        self.ends = list(zip(left.tolist(), (right + offset).tolist(), strict=True))
        self.edges = [[NONE] * colours for _ in range(nodes)]
        self.free = [(1 << colours) - 1] * nodes  # a bit for each colour that no edge of the node has
        self.colours = [NONE] * len(left)

    def colour(self, edge: int) -> None:
        """Give an edge a colour that is free at both ends; if there is none, make one free."""
        here, there = self.ends[edge]
        both = self.free[here] & self.free[there]
        if not both:
            both = self.free[here] & -self.free[here]
            self._make_free(there, _lowest(both), _lowest(self.free[there]))
        colour = _lowest(both)
        self._paint(edge, colour)
        self.free[here] ^= 1 << colour
        self.free[there] ^= 1 << colour

    def _make_free(self, node: int, wanted: int, spare: int) -> None:
        """Exchange two colours on the path from a node along edges of these colours in turn."""
        path, last = [], node
        for colour in cycle((wanted, spare)):
            edge = self.edges[last][colour]
            if edge == NONE:
                break
            path.append(edge)
            here, there = self.ends[edge]
            last = there if last == here else here
        for edge in path:
            here, there = self.ends[edge]
            self.edges[here][self.colours[edge]] = self.edges[there][self.colours[edge]] = NONE
        for edge in path:
            self._paint(edge, spare if self.colours[edge] == wanted else wanted)
        for end in (node, last):
            self.free[end] ^= 1 << wanted | 1 << spare

    def _paint(self, edge: int, colour: int) -> None:
        here, there = self.ends[edge]
        self.edges[here][colour] = self.edges[there][colour] = edge
        self.colours[edge] = colour


def _lowest(bits: int) -> int:
    """Return the number of the lowest bit that is set."""
    return (bits & -bits).bit_length() - 1
