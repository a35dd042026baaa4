"""The kernel that writes the rows of ``columns.py`` for all learners of a batch."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.array_tables import Addresses, reader
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.envs.spaces.columns import Part
from wildscav_engine.simulation.state import NOBODY, NOT_ELIMINATED, Agents, Ending, Matches, allocate_state
from wildscav_engine.simulation.systems.supplies import team_supplies
from wildscav_engine.simulation.systems.visibility import allocate_seen
from wildscav_engine.specs.rules import FRAME
from wildscav_engine.tracks.rewards import FACTS, Fact, Facts, RewardSum, TermArrays, write_facts, write_terms

Row = NDArray[np.float32]

POSITION, VELOCITY, VIEW, BODY = int(Part.POSITION), int(Part.VELOCITY), int(Part.VIEW), int(Part.BODY)
TIME, TARGET, SUPPLIES, VITALS = int(Part.TIME), int(Part.TARGET), int(Part.SUPPLIES), int(Part.VITALS)
WEAPON = int(Part.WEAPON)
STANDING, EVENTS, TERMS = int(Part.STANDING), int(Part.EVENTS), int(Part.TERMS)
TIME_UP = int(Ending.TIME_UP)
KILLS, DEATHS, HITS, HEALTH = int(Fact.KILLS), int(Fact.DEATHS), int(Fact.HITS), int(Fact.HEALTH)


class Desk(NamedTuple):
    """What the kernel works with besides the batch."""

    learners: NDArray[np.int64]  # (L,) their seats
    start: NDArray[np.int64]  # (PARTS,) the first column of each part, or -1 where it is not told
    fact: NDArray[np.int64]  # (T,) this and the next two: the reward terms, as in ``TermArrays``
    change: NDArray[np.int64]  # (T,)
    weight: NDArray[np.float32]  # (T,)
    before: Facts  # (B, A, FACTS) of the step before
    after: Facts  # (B, A, FACTS) written
    fresh: NDArray[np.bool_]  # (B,) which matches have begun since the step before; all False afterwards
    done: NDArray[np.bool_]  # (B, L) whose episode had ended before the step; brought up to date


def allocate_desk(
    matches: int, seats: int, learners: int, start: NDArray[np.int64], terms: TermArrays
) -> Desk:
    """Return a desk for a batch whose matches are all fresh, the first seats being the learners'."""
    facts = np.zeros((2, matches, seats, FACTS), np.float32)
    return Desk(
        learners=np.arange(learners),
        start=start,
        fact=terms.fact,
        change=terms.change,
        weight=terms.weight,
        before=facts[0],
        after=facts[1],
        fresh=np.ones(matches, np.bool_),
        done=np.zeros((matches, learners), np.bool_),
    )


_EXAMPLE = allocate_desk(1, 1, 1, np.zeros(1, np.int64), RewardSum({}).term_arrays)
# Kernels that take the arrays out of their tables.
agents_at = reader(allocate_state(1, 1, 1, 1).agents)
matches_at = reader(allocate_state(1, 1, 1, 1).matches)
seen_at = reader(allocate_seen(1, 1))
desk_at = reader(_EXAMPLE)


@kernel
def write_rows(
    agents: Addresses, matches: Addresses, seen: Addresses, desk: Addresses, rows: NDArray[np.float32]
) -> None:
    """Write the rows of all learners.

    Args:
        agents: The table of the batch's agents.
        matches: Of its matches.
        seen: Of what is seen.
        desk: Of the desk.
        rows: (B, L, width), written.
    """
    _write_rows(agents_at(agents), matches_at(matches), seen_at(seen).can_pick_up, desk_at(desk), rows)


@kernel
def _write_rows(
    agents: Agents, matches: Matches, can_pick_up: NDArray[np.bool_], desk: Desk, rows: NDArray[np.float32]
) -> None:
    write_facts(agents, matches, desk.after)
    for match in range(rows.shape[0]):
        for learner in range(rows.shape[1]):
            seat = desk.learners[learner]
            row = rows[match, learner]
            _write_body(agents, match, seat, desk.start, row)
            _write_task(agents, matches, can_pick_up, match, seat, desk.start, row)
            if desk.start[WEAPON] >= 0:
                _write_weapon(agents, match, seat, row[desk.start[WEAPON] :])
            _write_outcome(agents, matches, match, learner, desk, row)
        desk.fresh[match] = False


@kernel
def _write_body(agents: Agents, match: int, seat: int, start: NDArray[np.int64], row: Row) -> None:
    for axis in range(3):
        row[start[POSITION] + axis] = agents.position[match, seat, axis]
        row[start[VELOCITY] + axis] = agents.velocity[match, seat, axis]
    yaw, pitch = agents.yaw[match, seat], agents.pitch[match, seat]
    view = row[start[VIEW] :]
    view[0], view[1] = yaw, pitch
    view[2], view[3] = _sine(yaw), _cosine(yaw)
    view[4], view[5] = _sine(pitch), _cosine(pitch)
    body = row[start[BODY] :]
    body[0] = agents.health[match, seat] > 0
    body[1] = agents.on_ground[match, seat]
    body[2] = agents.in_water[match, seat]


@kernel
def _sine(angle: float) -> float:
    return max(-1.0, min(1.0, sine(angle)))


@kernel
def _cosine(angle: float) -> float:
    return max(-1.0, min(1.0, cosine(angle)))


@kernel
def _write_task(
    agents: Agents,
    matches: Matches,
    can_pick_up: NDArray[np.bool_],
    match: int,
    seat: int,
    start: NDArray[np.int64],
    row: Row,
) -> None:
    """Write the times, and of target and supplies what the track has."""
    row[start[TIME]] = max(0, matches.frame_limit[match] - matches.frame[match]) * FRAME
    row[start[TIME] + 1] = matches.frame[match] * FRAME
    if start[TARGET] >= 0:
        _write_target(agents, matches, match, seat, row[start[TARGET] : start[TARGET] + 8])
    if start[SUPPLIES] >= 0:
        supplies = row[start[SUPPLIES] :]
        supplies[0] = agents.supplies[match, seat]
        supplies[1] = agents.gained[match, seat]
        count, team = matches.seats[match], agents.team[match, seat]
        supplies[2] = team_supplies(agents.team[match, :count], agents.supplies[match, :count], team)
        supplies[3] = can_pick_up[match, seat]
    if start[VITALS] >= 0:
        vitals = row[start[VITALS] :]
        vitals[0] = agents.health[match, seat]
        vitals[1] = agents.respawn_left[match, seat] * FRAME
        vitals[2] = agents.invincible_left[match, seat] * FRAME


@kernel
def _write_target(agents: Agents, matches: Matches, match: int, seat: int, target: Row) -> None:
    """Write where the target is; all 0 as long as the learner does not know it."""
    if not agents.knows_target[match, seat]:
        target[:] = 0.0
        return
    target[0] = 1.0
    square = 0.0
    for axis in range(3):
        place = matches.target[match, axis]
        way = place - agents.position[match, seat, axis]
        target[1 + axis], target[4 + axis] = place, way
        square += way * way
    target[7] = np.sqrt(square)


@kernel
def _write_weapon(agents: Agents, match: int, seat: int, weapon: Row) -> None:
    weapon[0] = agents.clip[match, seat]
    weapon[1] = agents.spare_ammo[match, seat]
    weapon[2] = agents.reload_left[match, seat] * FRAME
    weapon[3] = agents.fired[match, seat]
    weapon[4] = agents.hit_seat[match, seat] != NOBODY
    weapon[5] = agents.hit_by_seat[match, seat] != NOBODY


@kernel
def _write_outcome(agents: Agents, matches: Matches, match: int, learner: int, desk: Desk, row: Row) -> None:
    """Write whether the learner's episode has ended, what happened to it and what it is paid."""
    seat = desk.learners[learner]
    after = desk.after[match, seat]
    before = after if desk.fresh[match] else desk.before[match, seat]
    events = row[desk.start[EVENTS] :]
    standing = row[desk.start[STANDING] :]
    terms = row[desk.start[TERMS] : desk.start[TERMS] + desk.fact.shape[0]]
    out = agents.eliminated[match, seat] != NOT_ELIMINATED
    over = matches.over[match]
    late = over and not out and matches.ending[match] == TIME_UP
    standing[0], standing[1] = (over or out) and not late, late
    if desk.done[match, learner]:
        terms[:] = 0.0
    else:
        write_terms(TermArrays(desk.fact, desk.change, desk.weight), before, after, terms)
    total = np.float32(0.0)
    for term in range(terms.shape[0]):
        total += terms[term]
    standing[2] = total
    desk.done[match, learner] |= over or out
    events[0] = agents.fired[match, seat]
    events[1] = after[HITS] - before[HITS]
    events[2] = agents.hit_by_seat[match, seat] != NOBODY
    events[3] = agents.gained[match, seat]
    events[4], events[5] = after[KILLS] - before[KILLS], after[DEATHS] - before[DEATHS]
    events[6] = before[HEALTH] <= 0.0 and after[HEALTH] > 0.0
