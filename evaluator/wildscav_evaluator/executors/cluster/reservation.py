"""How many cores a match reserves on a node."""

import math

from wildscav_evaluator.matches.jobs import Job


def cores_of(job: Job, largest_node: int) -> int:
    """Return the cores that a match reserves: those that its agents may use at the same time.

    The server needs none besides, since it computes while all agents wait for it. A match with more agents
    than any node has cores gets a whole node.

    Args:
        job: The match.
        largest_node: Cores of the node with the most cores.
    """
    wanted = math.ceil(len(job.seats) * job.limits.cpus)
    return max(1, min(wanted, largest_node))
