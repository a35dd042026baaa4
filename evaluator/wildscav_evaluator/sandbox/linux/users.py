"""The users as which agents run if root starts them."""

import itertools
import os

OWN_USERS = 0x7000_0000  # the first user number of agents; no user of a machine has such a high number
AT_ONCE = 64  # agents of one process at a time; with 2^22 processes, users stay below 2^31, as engines want
_slots = itertools.count()


def agent_user() -> int:
    """Return a user number for one agent, so that agents do not share what the kernel counts by user."""
    return OWN_USERS + os.getpid() * AT_ONCE + next(_slots) % AT_ONCE
