"""A 64-bit digest of a match's state: two simulations are the same exactly if their digests are.

Every word of the state goes through the mixing step of MurmurHash3 (Appleby 2011), chained from step to
step, the actions included, so that a change is noticed even where it has no effect at once.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.kernel import kernel
from wildscav_engine.rng import Word
from wildscav_engine.state import Agents, Supplies

FIRST_FACTOR, SECOND_FACTOR = np.uint64(0xFF51AFD7ED558CCD), np.uint64(0xC4CEB9FE1A85EC53)
SHIFT = np.uint64(33)


@kernel
def mix(digest: Word, word: Word) -> Word:
    """Return a digest with one more 64-bit word in it."""
    mixed = (np.uint64(digest) ^ np.uint64(word)) * FIRST_FACTOR
    mixed ^= mixed >> SHIFT
    mixed *= SECOND_FACTOR
    return mixed ^ (mixed >> SHIFT)


@kernel
def _mix_floats(digest: Word, values: NDArray[np.float64]) -> Word:
    for word in values.reshape(-1).view(np.uint64):
        digest = mix(digest, word)
    return digest


@kernel
def _mix_counts(digest: Word, values: NDArray[np.int32]) -> Word:
    for value in values:
        digest = mix(digest, np.uint64(np.int64(value)))
    return digest


@kernel
def _mix_flags(digest: Word, values: NDArray[np.bool_]) -> Word:
    for value in values:
        digest = mix(digest, np.uint64(1) if value else np.uint64(0))
    return digest


@kernel
def digest_step(
    digest: Word, agents: Agents, supplies: Supplies, actions: NDArray[np.float32], frame: int
) -> Word:
    """Return the digest after a step.

    Args:
        digest: Before the step.
        agents: The agents of the match.
        supplies: Its boxes.
        actions: (A, FIELDS) as played.
        frame: Of the match.

    Returns:
        64 bits.
    """
    digest = mix(np.uint64(digest), np.uint64(frame))
    for word in actions.reshape(-1).view(np.uint32):
        digest = mix(digest, np.uint64(word))
    for reals in (agents.position, agents.velocity, agents.memory, agents.shot_end):
        digest = _mix_floats(digest, reals)
    for reals in (agents.yaw, agents.pitch, agents.walked):
        digest = _mix_floats(digest, reals)
    for counts in (agents.health, agents.respawn_left, agents.invincible_left, agents.clip):
        digest = _mix_counts(digest, counts)
    for counts in (
        agents.spare_ammo,
        agents.reload_left,
        agents.fire_left,
        agents.supplies,
        agents.picked_up,
    ):
        digest = _mix_counts(digest, counts)
    for counts in (agents.kills, agents.deaths, agents.shots, agents.hits):
        digest = _mix_counts(digest, counts)
    for counts in (agents.hit_seat, agents.hit_by_seat, agents.gained, agents.placement):
        digest = _mix_counts(digest, counts)
    for flags in (agents.on_ground, agents.in_water, agents.reached, agents.knows_target, agents.fired):
        digest = _mix_flags(digest, flags)
    # Where boxes lie follows from the spec and from where agents died, so it need not be read each step.
    digest = _mix_counts(digest, supplies.quantity)
    return _mix_counts(digest, supplies.serial)
