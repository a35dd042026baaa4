"""Rewards as named terms: what a learner is paid for a step, from what is different after it.

The facts of all agents are read before and after the step; a term is what became of one of them.
``RewardSum`` weights and adds them up, so that each can be logged, replaced and mixed by name.
"""

from collections.abc import Mapping
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.simulation.state import Agents, Matches, State
from wildscav_engine.simulation.systems.elimination import placement_now


class Fact(IntEnum):
    """The columns of facts, float32."""

    REACHED = 0  # 1 at the target
    TARGET_DISTANCE = 1  # m, 0 without a target
    SUPPLIES = 2  # carried
    PICKED_UP = 3  # supplies picked up in all
    TEAM_PICKED_UP = 4  # by the whole team
    KILLS = 5
    DEATHS = 6
    HITS = 7
    HEALTH = 8  # hp
    OUTLIVED = 9  # by the placement as it stands: 0 as the last team, 1 as the first
    STEPS = 10  # played, the dead and the eliminated included
    WALKED = 11  # m
    PICKED_UP_BY_NUMBER = 12  # by the team whose number is that of the row


FACTS = len(Fact)
Facts = NDArray[np.float32]  # (…, FACTS)
Values = NDArray[np.float32]  # (…)


class Change(IntEnum):
    """How a term comes from one fact before and after a step."""

    MORE = 0  # by how much it has grown
    LESS = 1  # by how much it has shrunk
    HAS_MORE = 2  # 1 where it has grown at all
    LOST = 3  # by how much it has shrunk, and nothing where it has grown


_LESS, _HAS_MORE, _LOST = int(Change.LESS), int(Change.HAS_MORE), int(Change.LOST)


class Term(NamedTuple):
    """One way to be paid."""

    title: str
    fact: Fact
    change: Change


# The first two are the paper's (appendix, "Reward Configuration").
REWARD_TERMS: dict[str, Term] = {
    "target_reached": Term("1 in the step that reaches the target", Fact.REACHED, Change.HAS_MORE),
    "supply_found": Term("1 in a step that picks up supplies", Fact.PICKED_UP, Change.HAS_MORE),
    "supplies": Term("supplies picked up", Fact.PICKED_UP, Change.MORE),
    "team_supplies": Term("supplies picked up by the team", Fact.TEAM_PICKED_UP, Change.MORE),
    "supplies_lost": Term("supplies dropped at death", Fact.SUPPLIES, Change.LOST),
    "approach": Term("m that the target is nearer", Fact.TARGET_DISTANCE, Change.LESS),
    "walked": Term("m walked", Fact.WALKED, Change.MORE),
    "kill": Term("enemies killed", Fact.KILLS, Change.MORE),
    "death": Term("own deaths", Fact.DEATHS, Change.MORE),
    "hit": Term("hits on enemies", Fact.HITS, Change.MORE),
    "damage_taken": Term("hp lost", Fact.HEALTH, Change.LOST),
    "outlived": Term(
        "places won, as other teams go out or time is up: 1 from the last to the first",
        Fact.OUTLIVED,
        Change.MORE,
    ),
    "step": Term("1 in every step", Fact.STEPS, Change.MORE),
}


class Plan(NamedTuple):
    """The T terms of a sum, for kernels."""

    fact: NDArray[np.int64]  # (T,)
    change: NDArray[np.int64]  # (T,)
    weight: NDArray[np.float32]  # (T,)


class RewardSum:
    """A weighted sum of reward terms."""

    def __init__(self, weights: Mapping[str, float]) -> None:
        """Choose terms and their weights.

        Args:
            weights: By the names of ``REWARD_TERMS``.

        Raises:
            ValueError: There is no such term, or a weight is no finite number.
        """
        for name, weight in weights.items():
            if name not in REWARD_TERMS:
                raise ValueError(f"there is no reward term {name!r}; the terms are {', '.join(REWARD_TERMS)}")
            if isinstance(weight, bool) or not np.isfinite(weight):
                raise ValueError(f"the weight of reward term {name!r} is {weight!r}, must be a finite number")
        self.weights = {name: float(weight) for name, weight in weights.items()}
        terms = [REWARD_TERMS[name] for name in weights]
        self.plan = Plan(
            np.array([term.fact for term in terms], np.int64),
            np.array([term.change for term in terms], np.int64),
            np.array(list(self.weights.values()), np.float32),
        )

    def terms(self, before: Facts, after: Facts) -> dict[str, Values]:
        """Return what each term pays, weighted.

        Args:
            before: (…, FACTS) facts before a step.
            after: (…, FACTS) after it.

        Returns:
            (…) float32 by the names of terms.
        """
        rows = after.reshape(-1, FACTS)
        paid = np.empty((len(rows), len(self.weights)), np.float32)
        _pay_all(self.plan, before.reshape(-1, FACTS), rows, paid)
        values = paid.reshape(*after.shape[:-1], -1)
        return {name: values[..., place] for place, name in enumerate(self.weights)}

    def total(self, before: Facts, after: Facts) -> Values:
        """Return (…) float32, the sum of what all terms pay, in the order in which they were named."""
        total = np.zeros(after.shape[:-1], np.float32)
        for values in self.terms(before, after).values():
            total += values
        return total


@kernel
def _pay_all(plan: Plan, before: Facts, after: Facts, paid: Values) -> None:
    for row in range(after.shape[0]):
        pay(plan, before[row], after[row], paid[row])


@kernel
def pay(plan: Plan, before: Facts, after: Facts, paid: Values) -> None:
    """Write (T,) what each term pays, weighted, from (FACTS,) an agent's facts before and after a step."""
    for term in range(paid.shape[0]):
        fact, change = plan.fact[term], plan.change[term]
        more = after[fact] - before[fact]
        value = np.float32(more)
        if change == _LESS:
            value = np.float32(-more)
        elif change == _HAS_MORE:
            value = np.float32(1.0 if more > 0.0 else 0.0)
        elif change == _LOST:
            value = np.float32(max(-more, 0.0))
        paid[term] = value * plan.weight[term] + np.float32(0.0)  # never minus zero


def read_facts(state: State, facts: Facts) -> None:
    """Write the facts of all agents of a batch.

    Args:
        state: The batch.
        facts: (B, A, FACTS), written.
    """
    write_facts(state.agents, state.matches, facts)


@kernel
def write_facts(agents: Agents, matches: Matches, facts: Facts) -> None:
    """Do what ``read_facts`` says."""
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
    """Return how far a seat's team has come from the last place, 0, to the first, 1; 0 where it is alone."""
    others = matches.teams[match] - 1
    if others == 0:
        return 0.0
    placement = placement_now(agents.placement[match, seat], matches.teams_left[match], matches.over[match])
    return float((others + 1 - placement) / others)


@kernel
def _add_up_teams(agents: Agents, match: int, facts: Facts) -> None:
    """Write what the teams of a match have picked up, by their numbers and then for each of their seats."""
    facts[:, Fact.PICKED_UP_BY_NUMBER] = 0.0
    for seat in range(facts.shape[0]):
        facts[agents.team[match, seat], Fact.PICKED_UP_BY_NUMBER] += facts[seat, Fact.PICKED_UP]
    for seat in range(facts.shape[0]):
        facts[seat, Fact.TEAM_PICKED_UP] = facts[agents.team[match, seat], Fact.PICKED_UP_BY_NUMBER]
