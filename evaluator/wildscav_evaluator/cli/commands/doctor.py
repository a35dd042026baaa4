"""``wildscav doctor``: which sandboxes keep their promises on this machine, and which extensions work."""

from wildscav.cli.shared_options import AsJson
from wildscav_evaluator.cli.options.running import AddressOption, ExecutorOption, executor_of


def doctor(
    executor: ExecutorOption = "local", address: AddressOption = None, as_json: AsJson = False
) -> None:
    """Test every promise of every sandbox on this machine, and everything that other packages add.

    With --executor ray, test the nodes of a cluster instead: which can be used, and the sandboxes there.

    With --json: `sandboxes`: `name` and `promises` of each, and for each promise `name`, `kept`, `found` and
    `remedy`; `default`: the sandbox in which agents run by default; `extensions`: `group`, `name`, `origin`
    (`package` and `version`) and `problem` (why it cannot be used) of each.

    With --json, with --executor ray: `nodes`: `name`, `cores`, `problem` (why it gets no work at all) and
    `sandboxes` of each: for each sandbox what it lacks there, an empty text if nothing.
    """
    from wildscav_evaluator.cli.sessions.doctor import examine_nodes, examine_this_machine

    with executor_of(executor, address) as machines:
        if machines.name != "local":
            examine_nodes(machines, as_json=as_json)
        else:
            examine_this_machine(as_json=as_json)
