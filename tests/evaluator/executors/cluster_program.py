"""A Ray cluster of several nodes on this machine, as a program: it reads commands from stdin, a line each.

Every node has a loopback address of its own. It ends, with everything that it started, when stdin is closed.
"""

import json
import os
import sys
from typing import Any

MEMORY = 80 << 20  # bytes of each node's object store; Ray's least is 75 MiB


def main() -> None:
    """Start a head without cores, carry out commands, and answer each with a line."""
    settings = json.loads(sys.stdin.readline())
    if settings["ray_version"]:
        import ray

        ray.__version__ = settings["ray_version"]
    from ray.cluster_utils import Cluster

    head = {
        "num_cpus": 0,
        "include_dashboard": False,
        "include_log_monitor": False,
        "no_monitor": True,  # nobody scales it
        "object_store_memory": MEMORY,
        "node_ip_address": f"127.0.{settings['network']}.1",
        "node_name": "head",
    }
    cluster = Cluster(initialize_head=True, head_node_args=head)
    nodes: dict[str, Any] = {}
    print(cluster.address, flush=True)  # noqa: T201
    for line in sys.stdin:
        command = json.loads(line)
        if command["do"] == "add":
            nodes[command["name"]] = cluster.add_node(
                num_cpus=command["cores"],
                node_name=command["name"],
                node_ip_address=f"127.0.{settings['network']}.{len(nodes) + 2}",
                object_store_memory=MEMORY,
                env_vars=command["variables"],
            )
        elif command["name"] == "head":
            cluster.remove_node(cluster.head_node, allow_graceful=False)
        else:
            cluster.remove_node(nodes.pop(command["name"]), allow_graceful=False)
        print("done", flush=True)  # noqa: T201
    cluster.shutdown()
    os._exit(0)  # Ray's own cleaning up at exit would wait for a head that was killed


if __name__ == "__main__":
    main()
