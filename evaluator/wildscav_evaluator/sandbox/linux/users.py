"""The users that agents run as where root starts them."""

import itertools
import os

OWN_USERS = 0x7000_0000  # the first of the numbers that agents are given; no user of a machine has such
AT_ONCE = 128  # agents of one process
_slots = itertools.count()


def agent_user() -> int:
    """Return a user for one agent: its own, so that agents do not share what the kernel counts by user."""
    return OWN_USERS + os.getpid() * AT_ONCE + next(_slots) % AT_ONCE
