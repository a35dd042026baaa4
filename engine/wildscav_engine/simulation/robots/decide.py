"""Which robot decides for which seat: a kernel that is made of the kernels of all robots.

It is a chain: each link asks for one kind of robot, and calls the next link for all others. Links are
inlined, so that what is compiled is one branch for each kind. With the robots of another package, other code
is compiled, and kept apart (see ``KERNELS_OF`` in ``compilation/sources.py``).
"""

from collections.abc import Callable, Iterable
from types import FunctionType

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.extensions import ExtensionError, Registry
from wildscav_engine.simulation.robots.base import Act, Robot, Situation

KERNELS_OF = "wildscav.robots"
KINDS: Registry[tuple[Robot, ...]] = Registry(KERNELS_OF)


@inlined_kernel
def _stand_still(now: Situation, action: NDArray[np.float32]) -> None:
    """Do nothing: no robot has this number."""


# What a link is made from; each has its own values of these.
_KIND: int = 0
_act: Act = _stand_still
_others: Act = _stand_still


def _link(now: Situation, action: NDArray[np.float32]) -> None:
    if now.agents.robot[now.seat] // 10 == _KIND:
        _act(now, action)
    else:
        _others(now, action)


def chain(kinds: Iterable[tuple[Robot, ...]]) -> Act:
    """Return the kernel that lets the robot in a seat decide.

    Args:
        kinds: The levels of each kind.

    Raises:
        ExtensionError: Two robots have the same name or number.
    """
    links = list(kinds)
    _check_apart([robot for levels in links for robot in levels])
    decide: Act = _stand_still
    for number, levels in reversed(list(enumerate(links))):
        make = kernel if number == 0 else inlined_kernel
        decide = make(_linked(levels[0], decide))
    return decide


def _linked(robot: Robot, others: Act) -> Callable[[Situation, NDArray[np.float32]], None]:
    """Return the function of one link, with a name of its own for the cache of compiled code."""
    kind = robot.number // 10
    values = {"_KIND": kind, "_act": robot.act, "_others": others}
    name = f"decide_{kind}"
    link = FunctionType(_link.__code__.replace(co_name=name, co_qualname=name), {**globals(), **values}, name)
    link.__doc__ = "Write what the robot in a seat does in the coming step; the row holds zeros before."
    return link


def _check_apart(robots: list[Robot]) -> None:
    for what in ("name", "number"):
        found: dict[str | int, Robot] = {}
        for robot in robots:
            before = found.setdefault(getattr(robot, what), robot)
            if before is not robot:
                raise ExtensionError(
                    f"the robots {before.name!r} and {robot.name!r} have the same {what}; uninstall the "
                    "package of one of them"
                )


ROBOTS = {robot.name: robot for levels in KINDS.values() for robot in levels}
decide = chain(KINDS.values())
