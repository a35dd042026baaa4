"""A 64-bit digest of a match's state, which shows whether two simulations are identical.

It is chained from step to step and includes the actions, so that it reveals a difference even before that
has any effect. The state of agents is mixed in as 64-bit words by the rounds of XXH64 (Collet 2012), in four
lanes that a processor works on in parallel. Boxes are mixed in when they change: at the start, when an agent
takes them and when an agent drops them.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Word
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.simulation.state import (
    DIGESTED_COUNTS,
    DIGESTED_NUMBERS,
    Agents,
    Supplies,
    allocate_state,
    digested,
)
from wildscav_engine.specs.actions import FIELDS

FIRST_FACTOR, SECOND_FACTOR = np.uint64(0xFF51AFD7ED558CCD), np.uint64(0xC4CEB9FE1A85EC53)
SHIFT = np.uint64(33)
ROUND_FACTOR, WORD_FACTOR = np.uint64(0x9E3779B185EBCA87), np.uint64(0xC2B2AE3D27D4EB4F)
LEFT_31, RIGHT_33 = np.uint64(31), np.uint64(33)
LOW_32, SHIFT_32 = np.uint64(0xFFFFFFFF), np.uint64(32)

# The words of a seat: two fields of its action in each, then the numbers, and two counts in each.
NUMBERS = sum(getattr(allocate_state(1, 1, 1).agents, name)[0, 0].size for name in DIGESTED_NUMBERS)
FACTS = NUMBERS + len(DIGESTED_COUNTS)
WORDS = -(-((FIELDS + 1) // 2 + NUMBERS + (len(DIGESTED_COUNTS) + 1) // 2 + 1) // 4) * 4

Lanes = tuple[Word, Word, Word, Word]


@kernel
def mix(digest: Word, word: Word) -> Word:
    """Mix a 64-bit word into a digest: the mixing step of MurmurHash3 (Appleby 2011)."""
    mixed = (np.uint64(digest) ^ np.uint64(word)) * FIRST_FACTOR
    mixed ^= mixed >> SHIFT
    mixed *= SECOND_FACTOR
    return mixed ^ (mixed >> SHIFT)


@inlined_kernel
def _round(lane: Word, word: Word) -> Word:
    mixed = np.uint64(lane) + np.uint64(word) * WORD_FACTOR
    return ((mixed << LEFT_31) | (mixed >> RIGHT_33)) * ROUND_FACTOR


@inlined_kernel
def _rounds(lanes: Lanes, one: Word, two: Word, three: Word, four: Word) -> Lanes:
    return _round(lanes[0], one), _round(lanes[1], two), _round(lanes[2], three), _round(lanes[3], four)


@inlined_kernel
def _pair(low: int, high: int) -> Word:
    """Return two 32-bit numbers as one word."""
    return (np.uint64(np.int64(low)) & LOW_32) | (np.uint64(np.int64(high)) << SHIFT_32)


@inlined_kernel
def _word(played: NDArray[np.uint32], facts: NDArray[np.float64], seat: int, place: int) -> Word:
    """Return one of the words of a seat: its action, then numbers, pairs of counts, and last its number."""
    first = 2 * place
    if first < FIELDS:
        return np.uint64(played[first]) | (
            np.uint64(played[first + 1] if first + 1 < FIELDS else 0) << SHIFT_32
        )
    place -= (FIELDS + 1) // 2
    if place < NUMBERS:
        return np.float64(facts[place]).view(np.uint64)
    first = NUMBERS + 2 * (place - NUMBERS)
    if first < FACTS:
        return _pair(int(facts[first]), int(facts[first + 1]) if first + 1 < FACTS else 0)
    return np.uint64(seat)


@inlined_kernel
def digest_step(digest: Word, agents: Agents, actions: NDArray[np.float32], frame: int) -> Word:
    """Return the digest after a step, by the (A, FIELDS) actions played and the number of frames so far."""
    start = mix(digest, np.uint64(frame))
    lanes: Lanes = (start, start ^ FIRST_FACTOR, start ^ SECOND_FACTOR, start ^ WORD_FACTOR)
    played = actions.view(np.uint32)
    memory, shot_end = agents.memory.view(np.uint64), agents.shot_end.view(np.uint64)
    for seat in range(agents.health.shape[0]):
        row, facts = played[seat], digested(agents, seat)
        for place in range(0, WORDS, 4):
            lanes = _rounds(
                lanes,
                _word(row, facts, seat, place),
                _word(row, facts, seat, place + 1),
                _word(row, facts, seat, place + 2),
                _word(row, facts, seat, place + 3),
            )
        # Without a shot or without a robot, these have not changed.
        if agents.fired[seat]:
            lanes = _rounds(lanes, shot_end[seat, 0], shot_end[seat, 1], shot_end[seat, 2], np.uint64(1))
        if agents.robot[seat] != 0:
            for first in (0, 4, 8):
                one, two, three = memory[seat, first], memory[seat, first + 1], memory[seat, first + 2]
                lanes = _rounds(lanes, one, two, three, memory[seat, first + 3])
    return mix(mix(mix(lanes[0], lanes[1]), lanes[2]), lanes[3])


@kernel
def digest_box(digest: Word, supplies: Supplies, slot: int) -> Word:
    """Mix the present box of a slot into a digest."""
    position = supplies.position[slot].view(np.uint32)
    digest = mix(digest, _pair(slot, supplies.quantity[slot]))
    digest = mix(digest, _pair(supplies.serial[slot], supplies.appears[slot]))
    digest = mix(digest, np.uint64(position[0]) | (np.uint64(position[1]) << SHIFT_32))
    return mix(digest, np.uint64(position[2]))


@kernel
def digest_boxes(digest: Word, supplies: Supplies) -> Word:
    """Mix all boxes into a digest."""
    for slot in range(supplies.quantity.shape[0]):
        digest = digest_box(digest, supplies, slot)
    return digest
