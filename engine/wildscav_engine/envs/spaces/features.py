"""The kernel that writes the rows defined in ``columns.py`` for all learners of a batch."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, exponential, logarithm, sine
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.compilation.tables.array_tables import Addresses, reader, values_reader
from wildscav_engine.envs.spaces.columns import FACT_NAMES, FACT_PARTS, GROUPS, YES, Part
from wildscav_engine.simulation.batch_kernels import batch_at
from wildscav_engine.simulation.state import (
    NOBODY,
    NOT_ELIMINATED,
    Agents,
    Ending,
    Matches,
    Supplies,
    agents_at,
    allocate_state,
    axes_of,
    matches_at,
    supplies_at,
)
from wildscav_engine.simulation.systems.supplies import team_supplies
from wildscav_engine.simulation.systems.visibility import Seen, allocate_seen
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.rules import FRAME
from wildscav_engine.tracks.rewards import FACTS, Fact, Facts, RewardSum, TermArrays, write_facts, write_terms

Row = NDArray[np.float32]

POSITION, VELOCITY, VIEW = int(Part.POSITION), int(Part.VELOCITY), int(Part.VIEW)
TIME, TARGET, SUPPLIES = int(Part.TIME), int(Part.TARGET), int(Part.SUPPLIES)
OUTCOME, EVENTS, TERMS = int(Part.OUTCOME), int(Part.EVENTS), int(Part.TERMS)
TO_TARGET, TO_BOX, TO_ENEMY = int(Part.TO_TARGET), int(Part.TO_BOX), int(Part.TO_ENEMY)
TIME_UP = int(Ending.TIME_UP)
KILLS, DEATHS, HITS, HEALTH = int(Fact.KILLS), int(Fact.DEATHS), int(Fact.HITS), int(Fact.HEALTH)
NEAR = 5.0  # m, at which the nearness has fallen to 1 / e
WIDTH = 9  # columns of a direction

# The columns that are facts: their part and their place in it, and their field of ``Agents``.
_FACTS = [
    (part, place, column, FACT_NAMES.get(column.name, column.name))
    for part in FACT_PARTS
    for place, column in enumerate(GROUPS[part].columns)
]
FACT_PLACE = np.array([(part, place) for part, place, _, _ in _FACTS])  # (F, 2)
# (F,) the factor of each, 0 for whether it differs from FACT_NONE.
FACT_UNIT = np.array([{YES: 0.0, "s": FRAME}.get(column.unit, 1.0) for _, _, column, _ in _FACTS])
FACT_NONE = np.array([float(axes_of(Agents)[name][1].fill) for _, _, _, name in _FACTS])


class RowWorkspace(NamedTuple):
    """The inputs and the state of the kernel in addition to the batch."""

    learners: NDArray[np.int64]  # (L,) the seats of the learners
    start: NDArray[np.int64]  # (PARTS,) the first column of each part, or -1 if absent
    fact: NDArray[np.int64]  # (T,) with the next two fields: the reward terms, as in ``TermArrays``
    change: NDArray[np.int64]  # (T,)
    weight: NDArray[np.float32]  # (B, T)
    before: Facts  # (B, A, FACTS) of the previous step
    after: Facts  # (B, A, FACTS) of this step, written
    is_new: NDArray[np.bool_]  # (B,) matches started since the previous step; cleared
    done: NDArray[np.bool_]  # (B, L) whether the episode ended before the step; updated
    terminated: NDArray[np.bool_]  # (B, L) with the next two: the outcome of the step, written
    truncated: NDArray[np.bool_]  # (B, L)
    rewards: NDArray[np.float64]  # (B, L)
    eyes: NDArray[np.float64]  # (B × L, 3) m, with the next two: where the learners look from, written
    yaws: NDArray[np.float64]  # (B × L,) degrees
    pitches: NDArray[np.float64]  # (B × L,) degrees


def allocate_row_workspace(
    matches: int, seats: int, learners: Sequence[int], start: NDArray[np.int64], terms: TermArrays
) -> RowWorkspace:
    """Return the workspace of a batch of new matches."""
    facts, shape = np.zeros((2, matches, seats, FACTS), np.float32), (matches, len(learners))
    return RowWorkspace(
        learners=np.array(learners, np.int64),
        start=start,
        fact=terms.fact,
        change=terms.change,
        weight=np.tile(terms.weight, (matches, 1)),
        before=facts[0],
        after=facts[1],
        is_new=np.ones(matches, np.bool_),
        done=np.zeros(shape, np.bool_),
        terminated=np.zeros(shape, np.bool_),
        truncated=np.zeros(shape, np.bool_),
        rewards=np.zeros(shape),
        eyes=np.zeros((matches * len(learners), 3)),
        yaws=np.zeros(matches * len(learners)),
        pitches=np.zeros(matches * len(learners)),
    )


_EXAMPLE = allocate_row_workspace(1, 1, [0], np.zeros(1, np.int64), RewardSum({}).term_arrays)
# Kernels that read the arrays from their tables.
seen_at = reader(allocate_seen(1, 1))
workspace_at = reader(_EXAMPLE)
facts_of = values_reader(allocate_state(1, 1, 1).agents, [name for _, _, _, name in _FACTS])


class View(NamedTuple):
    """Where a learner is and looks: what several groups of columns need."""

    x: float  # m, of the soles
    y: float
    z: float
    yaw_sine: float
    yaw_cosine: float
    pitch_sine: float
    pitch_cosine: float


@kernel
def write_rows(
    table: Addresses,
    workspace_table: Addresses,
    rows: NDArray[np.float32],
) -> int:
    """Write (B, L, width) the rows of all learners; return how many matches have no episode left."""
    batch = batch_at(table)
    agents, supplies = agents_at(batch.agents), supplies_at(batch.supplies)
    matches, seen = matches_at(batch.matches), seen_at(batch.seen)
    workspace = workspace_at(workspace_table)
    write_facts(agents, matches, workspace.after)
    ended = 0
    for match in range(rows.shape[0]):
        is_done = True
        for learner in range(rows.shape[1]):
            seat = workspace.learners[learner]
            row = rows[match, learner]
            view = _view_of(agents, match, seat)
            _write_body(agents, match, seat, view, workspace.start, row)
            _write_task(agents, matches, seen.can_pick_up, match, seat, workspace.start, row)
            _write_directions(agents, supplies, matches, seen, match, seat, view, workspace.start, row)
            _write_facts(agents, match, seat, workspace.start, row)
            _write_outcome(agents, matches, match, learner, workspace, row)
            _write_eyes(agents, match, learner, workspace)
            is_done = is_done and workspace.done[match, learner]
        workspace.is_new[match] = False
        ended += is_done
    return ended


@inlined_kernel
def _view_of(agents: Agents, match: int, seat: int) -> View:
    soles, yaw, pitch = agents.position[match, seat], agents.yaw[match, seat], agents.pitch[match, seat]
    return View(soles[0], soles[1], soles[2], sine(yaw), cosine(yaw), sine(pitch), cosine(pitch))


@inlined_kernel
def _write_body(
    agents: Agents, match: int, seat: int, view: View, start: NDArray[np.int64], row: Row
) -> None:
    for axis in range(3):
        row[start[POSITION] + axis] = agents.position[match, seat, axis]
        row[start[VELOCITY] + axis] = agents.velocity[match, seat, axis]
    angles = row[start[VIEW] :]
    angles[0], angles[1] = agents.yaw[match, seat], agents.pitch[match, seat]
    angles[2], angles[3] = _share(view.yaw_sine), _share(view.yaw_cosine)
    angles[4], angles[5] = _share(view.pitch_sine), _share(view.pitch_cosine)


@inlined_kernel
def _write_task(
    agents: Agents,
    matches: Matches,
    can_pick_up: NDArray[np.bool_],
    match: int,
    seat: int,
    start: NDArray[np.int64],
    row: Row,
) -> None:
    """Write the times, and the target and the supplies if the track has them."""
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


@inlined_kernel
def _write_target(agents: Agents, matches: Matches, match: int, seat: int, target: Row) -> None:
    """Write the position of the target; all 0 while the learner does not know it."""
    if not agents.knows_target[match, seat]:
        target[:] = 0.0
        return
    target[0] = 1.0
    square = 0.0
    for axis in range(3):
        place = matches.target[match, axis]
        offset = place - agents.position[match, seat, axis]
        target[1 + axis], target[4 + axis] = place, offset
        square += offset * offset
    target[7] = np.sqrt(square)


@inlined_kernel
def _write_directions(
    agents: Agents,
    supplies: Supplies,
    matches: Matches,
    seen: Seen,
    match: int,
    seat: int,
    view: View,
    start: NDArray[np.int64],
    row: Row,
) -> None:
    """Write the ways to the target, the nearest box and the nearest enemy that the observation has."""
    if start[TO_TARGET] >= 0:
        way = row[start[TO_TARGET] : start[TO_TARGET] + WIDTH]
        _write_to_target(agents.knows_target[match, seat], matches.target[match], view, way)
    if start[TO_BOX] >= 0:
        way = row[start[TO_BOX] : start[TO_BOX] + WIDTH]
        _write_to_box(supplies.position[match], seen.supplies[match, seat, 0], view, way)
    if start[TO_ENEMY] >= 0:
        way = row[start[TO_ENEMY] : start[TO_ENEMY] + WIDTH]
        _write_to_enemy(agents, seen, match, seat, view, way)


@inlined_kernel
def _write_facts(agents: Agents, match: int, seat: int, start: NDArray[np.int64], row: Row) -> None:
    """Write the groups of facts about the learner that its track has."""
    values = facts_of(agents, match * agents.team.shape[1] + seat)
    for place in range(FACT_PLACE.shape[0]):
        first = start[FACT_PLACE[place, 0]]
        if first >= 0:
            is_so = 1.0 if values[place] != FACT_NONE[place] else 0.0
            unit = FACT_UNIT[place]
            row[first + FACT_PLACE[place, 1]] = values[place] * unit if unit != 0.0 else is_so


@inlined_kernel
def _write_outcome(
    agents: Agents, matches: Matches, match: int, learner: int, workspace: RowWorkspace, row: Row
) -> None:
    """Write whether the learner's episode has ended, its events and its reward."""
    seat = workspace.learners[learner]
    after = workspace.after[match, seat]
    before = after if workspace.is_new[match] else workspace.before[match, seat]
    events = row[workspace.start[EVENTS] :]
    outcome = row[workspace.start[OUTCOME] :]
    terms = row[workspace.start[TERMS] : workspace.start[TERMS] + workspace.fact.shape[0]]
    eliminated = agents.eliminated[match, seat] != NOT_ELIMINATED
    over = matches.over[match]
    timed_out = over and not eliminated and matches.ending[match] == TIME_UP
    terminated = (over or eliminated) and not timed_out
    outcome[0], outcome[1] = terminated, timed_out
    if workspace.done[match, learner]:
        terms[:] = 0.0
    else:
        write_terms(
            TermArrays(workspace.fact, workspace.change, workspace.weight[match]), before, after, terms
        )
    total = np.float32(0.0)
    for term in range(terms.shape[0]):
        total += terms[term]
    outcome[2] = total
    workspace.terminated[match, learner], workspace.truncated[match, learner] = terminated, timed_out
    workspace.rewards[match, learner] = total
    workspace.done[match, learner] |= over or eliminated
    events[0] = agents.fired[match, seat]
    events[1] = after[HITS] - before[HITS]
    events[2] = agents.hit_by_seat[match, seat] != NOBODY
    events[3] = agents.gained[match, seat]
    events[4], events[5] = after[KILLS] - before[KILLS], after[DEATHS] - before[DEATHS]
    events[6] = before[HEALTH] <= 0.0 and after[HEALTH] > 0.0


@inlined_kernel
def _write_eyes(agents: Agents, match: int, learner: int, workspace: RowWorkspace) -> None:
    seat, view = workspace.learners[learner], match * workspace.learners.shape[0] + learner
    for axis in range(3):
        workspace.eyes[view, axis] = agents.position[match, seat, axis]
    workspace.eyes[view, 1] += EYE_HEIGHT
    workspace.yaws[view] = agents.yaw[match, seat]
    workspace.pitches[view] = agents.pitch[match, seat]


@inlined_kernel
def _write_to_target(is_known: bool, target: NDArray[np.float64], view: View, row: Row) -> None:
    """Write (WIDTH,) the way to the target; all 0 while the learner does not know it."""
    row[:] = 0.0
    if is_known:
        _write_direction(view, target[0], target[1], target[2], row)


@inlined_kernel
def _write_to_box(boxes: NDArray[np.float32], nearest: int, view: View, row: Row) -> None:
    """Write (WIDTH,) the way to the nearest supply box; all 0 if none is in sight."""
    row[:] = 0.0
    if nearest >= 0:
        box = boxes[nearest]
        _write_direction(view, float(box[0]), float(box[1]), float(box[2]), row)


@inlined_kernel
def _write_to_enemy(agents: Agents, seen: Seen, match: int, seat: int, view: View, row: Row) -> None:
    """Write (WIDTH,) the way to the nearest agent of another team; all 0 if none is in sight."""
    row[:] = 0.0
    for place in range(seen.agent_count[match, seat]):
        other = seen.agents[match, seat, place]
        if agents.team[match, other] != agents.team[match, seat]:
            soles = agents.position[match, other]
            _write_direction(view, soles[0], soles[1], soles[2], row)
            return


@kernel
def _write_direction(view: View, x: float, y: float, z: float, row: Row) -> None:
    """Write the way from the soles of a learner to a place; no direction if it is there.

    Offsets in metres along the axes of the world hide both direction and nearness from a network: it would
    have to divide by the distance, and to turn the direction by the yaw to know where to walk.
    """
    east, up, north = x - view.x, y - view.y, z - view.z
    distance = np.sqrt(east * east + up * up + north * north)
    row[0] = 1.0
    if distance > 0.0:
        east, up, north = east / distance, up / distance, north / distance
        row[1], row[2], row[3] = _share(east), _share(up), _share(north)
        row[4] = _share(east * view.yaw_cosine - north * view.yaw_sine)
        row[5] = _share(east * view.yaw_sine + north * view.yaw_cosine)
        level = np.sqrt(east * east + north * north)
        # The sum of the elevation and the pitch, which grows downwards.
        row[6] = _share(up * view.pitch_cosine + level * view.pitch_sine)
    row[7] = exponential(-distance / NEAR)
    row[8] = logarithm(1.0 + distance)


@kernel
def _share(value: float) -> float:
    return max(-1.0, min(1.0, value))
