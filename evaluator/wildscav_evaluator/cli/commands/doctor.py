"""``wildscav doctor``: which sandboxes keep their promises on this machine, and which extensions work."""

from wildscav.cli.shared_options import AsJson
from wildscav_evaluator.cli.options.running import AddressOption, ExecutorOption, executor_of


def doctor(
    executor: ExecutorOption = "local", address: AddressOption = None, as_json: AsJson = False
) -> None:
    """Test every promise of every sandbox on this machine, and everything that other packages add.

    With --executor ray, test the nodes of a cluster instead: which can be used, and the sandboxes there.
    """
    from wildscav_evaluator.cli.sessions.doctor import examine_nodes, examine_this_machine

    with executor_of(executor, address) as machines:
        if machines.name != "local":
            examine_nodes(machines, as_json=as_json)
        else:
            examine_this_machine(as_json=as_json)
