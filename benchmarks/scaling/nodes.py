"""Nodes of a cluster, simulated: one command hands matches to all cores, and collects their results.

The simulation has the times that ``benchmarks.services.executor`` measures on one node of two cores. It
leaves out networks, failures, and the object store.
"""

import heapq

COMMAND = 0.009  # s of processor time of the command and its connection, for each match
LEDGER = 0.0009  # s for the two entries of a match in the ledger, flushed to disk
CORES = 16  # of each node
QUICK = 2.35  # s of a match of the official suite with quick agents, on a node with a match on each core
THINKING = 35.0  # s of the mean official match if an agent thinks for 10 ms a step
FIRST_MAP = 1.0  # s until a node has its first map
COMPILATION = 60.0  # s until a node that never ran this version has compiled the engine
MATCHES_A_CORE = 20


def nodes(count: int) -> dict[str, float]:
    """Return matches a second, simulated, from a cold start to the last result."""
    return {
        "quick_agents": matches_a_second(count, QUICK, FIRST_MAP),
        "thinking_agents": matches_a_second(count, THINKING, FIRST_MAP),
        "quick_agents_new_nodes": matches_a_second(count, QUICK, FIRST_MAP + COMPILATION),
    }


def matches_a_second(count: int, match: float, first: float) -> float:
    """Simulate an evaluation on some nodes, each of whose cores plays one match after the other.

    A match takes some seconds, and the first of a core waits some more.
    """
    cores = [(0.0, core) for core in range(count * CORES)]  # when each is free
    planned, command, last = len(cores) * MATCHES_A_CORE, 0.0, 0.0
    for number in range(planned):
        free, core = heapq.heappop(cores)
        command = max(command, free) + COMMAND + LEDGER
        end = command + match + (first if number < count * CORES else 0.0)
        last = max(last, end)
        heapq.heappush(cores, (end, core))
    return planned / last
