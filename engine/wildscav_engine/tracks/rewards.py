"""Rewards as weighted sums of named terms.

Each term is the change of one fact about an agent in a step, such as the supplies that it carries. The facts
of all agents are read before and after the step. ``RewardSum`` weights and adds up terms that are chosen by
name, so that each can be logged on its own.
"""

from collections.abc import Mapping
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.state import Agents, Matches
from wildscav_engine.simulation.systems.elimination import current_placement


class Fact(IntEnum):
    """The columns of a row of facts about an agent, float32."""

    REACHED = 0  # 1 at the target
    TARGET_DISTANCE = 1  # m, 0 without a target
    SUPPLIES = 2  # carried now
    PICKED_UP = 3  # supplies picked up since the start
    TEAM_PICKED_UP = 4  # the same, by the whole team
    KILLS = 5
    DEATHS = 6
    HITS = 7
    HEALTH = 8  # hp
    OUTLIVED = 9  # from the current placement: 0 for the last team, 1 for the first
    STEPS = 10  # played, including steps after death or elimination
    WALKED = 11  # m
    PICKED_UP_BY_NUMBER = 12  # supplies picked up by the team whose number is that of the row


FACTS = len(Fact)
Facts = NDArray[np.float32]  # (…, FACTS)
Values = NDArray[np.float32]  # (…)


class Change(IntEnum):
    """How a term depends on a fact before and after a step."""

    INCREASE = 0
    DECREASE = 1
    HAS_INCREASED = 2  # 1 if it has increased, else 0
    LOSS = 3  # the decrease, or 0 if it has increased


_DECREASE, _HAS_INCREASED, _LOSS = int(Change.DECREASE), int(Change.HAS_INCREASED), int(Change.LOSS)


class Term(NamedTuple):
    """One term of a reward."""

    title: str
    fact: Fact
    change: Change


# The first two are the paper's (appendix, "Reward Configuration").
REWARD_TERMS: dict[str, Term] = {
    "target_reached": Term("1 in the step that reaches the target", Fact.REACHED, Change.HAS_INCREASED),
    "supply_found": Term("1 in a step that picks up supplies", Fact.PICKED_UP, Change.HAS_INCREASED),
    "supplies": Term("supplies picked up", Fact.PICKED_UP, Change.INCREASE),
    "team_supplies": Term("supplies picked up by the team", Fact.TEAM_PICKED_UP, Change.INCREASE),
    "supplies_lost": Term("supplies dropped on death", Fact.SUPPLIES, Change.LOSS),
    "approach": Term("m by which the target is nearer", Fact.TARGET_DISTANCE, Change.DECREASE),
    "walked": Term("m walked", Fact.WALKED, Change.INCREASE),
    "kill": Term("enemies killed", Fact.KILLS, Change.INCREASE),
    "death": Term("own deaths", Fact.DEATHS, Change.INCREASE),
    "hit": Term("hits on enemies", Fact.HITS, Change.INCREASE),
    "damage_taken": Term("hp lost", Fact.HEALTH, Change.LOSS),
    "outlived": Term(
        "placements gained as other teams are eliminated or time is up: 1 in all, from last to first",
        Fact.OUTLIVED,
        Change.INCREASE,
    ),
    "step": Term("1 in every step", Fact.STEPS, Change.INCREASE),
}


class TermArrays(NamedTuple):
    """The T terms of a reward, for kernels."""

    fact: NDArray[np.int64]  # (T,)
    change: NDArray[np.int64]  # (T,)
    weight: NDArray[np.float32]  # (T,)


class RewardSum:
    """A weighted sum of reward terms."""

    def __init__(self, weights: Mapping[str, float]) -> None:
        """Choose terms of ``REWARD_TERMS`` and their weights; ValueError if one is invalid."""
        for name, weight in weights.items():
            if name not in REWARD_TERMS:
                raise ValueError(f"there is no reward term {name!r}; the terms are {', '.join(REWARD_TERMS)}")
            if isinstance(weight, bool) or not np.isfinite(weight):
                raise ValueError(f"the weight of reward term {name!r} is {weight!r}, must be a finite number")
        self.weights = {name: float(weight) for name, weight in weights.items()}
        terms = [REWARD_TERMS[name] for name in weights]
        self.term_arrays = TermArrays(
            np.array([term.fact for term in terms], np.int64),
            np.array([term.change for term in terms], np.int64),
            np.array(list(self.weights.values()), np.float32),
        )


@kernel
def write_terms(terms: TermArrays, before: Facts, after: Facts, values: Values) -> None:
    """Write (T,) the weighted terms of a reward from (FACTS,) an agent's facts before and after a step."""
    for term in range(values.shape[0]):
        fact, change = terms.fact[term], terms.change[term]
        increase = after[fact] - before[fact]
        value = np.float32(increase)
        if change == _DECREASE:
            value = np.float32(-increase)
        elif change == _HAS_INCREASED:
            value = np.float32(1.0 if increase > 0.0 else 0.0)
        elif change == _LOSS:
            value = np.float32(max(-increase, 0.0))
        values[term] = value * terms.weight[term] + np.float32(0.0)  # never minus zero


@kernel
def write_facts(agents: Agents, matches: Matches, facts: Facts) -> None:
    """Write (B, A, FACTS) the facts about all agents of a batch."""
    for match in range(facts.shape[0]):
        for seat in range(matches.seats[match]):
            row = facts[match, seat]
            row[Fact.REACHED] = agents.reached[match, seat]
            row[Fact.TARGET_DISTANCE] = _target_distance(agents, matches, match, seat)
            row[Fact.SUPPLIES] = agents.supplies[match, seat]
            row[Fact.PICKED_UP] = agents.picked_up[match, seat]
            row[Fact.KILLS] = agents.kills[match, seat]
            row[Fact.DEATHS] = agents.deaths[match, seat]
            row[Fact.HITS] = agents.hits[match, seat]
            row[Fact.HEALTH] = agents.health[match, seat]
            row[Fact.OUTLIVED] = _outlived(agents, matches, match, seat)
            row[Fact.STEPS] = matches.step[match]
            row[Fact.WALKED] = agents.walked[match, seat]
        _add_up_teams(agents, match, facts[match, : matches.seats[match]])


@kernel
def _target_distance(agents: Agents, matches: Matches, match: int, seat: int) -> float:
    if not matches.has_target[match]:
        return 0.0
    dx = agents.position[match, seat, 0] - matches.target[match, 0]
    dy = agents.position[match, seat, 1] - matches.target[match, 1]
    dz = agents.position[match, seat, 2] - matches.target[match, 2]
    return float(np.sqrt(dx * dx + dy * dy + dz * dz))


@kernel
def _outlived(agents: Agents, matches: Matches, match: int, seat: int) -> float:
    """Return the current placement of a seat's team: 0 for the last, 1 for the first; 0 for a single team."""
    others = matches.teams[match] - 1
    if others == 0:
        return 0.0
    placement = current_placement(
        agents.placement[match, seat], matches.teams_left[match], matches.over[match]
    )
    return float((others + 1 - placement) / others)


@kernel
def _add_up_teams(agents: Agents, match: int, facts: Facts) -> None:
    """Write what the teams of a match have picked up, by team number and then for each seat."""
    facts[:, Fact.PICKED_UP_BY_NUMBER] = 0.0
    for seat in range(facts.shape[0]):
        facts[agents.team[match, seat], Fact.PICKED_UP_BY_NUMBER] += facts[seat, Fact.PICKED_UP]
    for seat in range(facts.shape[0]):
        facts[seat, Fact.TEAM_PICKED_UP] = facts[agents.team[match, seat], Fact.PICKED_UP_BY_NUMBER]
