"""The kernel that lets the robot in a seat decide, composed of the kernels of all robots.

It is a chain: each link handles one kind of robot, and calls the next link for all other kinds. Links are
inlined, so the compiled code has one branch for each kind. With robots of another package, the code differs
and has its own cache folder (see ``KERNELS_OF`` in ``compilation/caching/sources.py``).
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
    """Do nothing; the end of the chain, for numbers that no robot has."""


# The globals of a link; each link has its own values of these.
_KIND: int = 0
_act: Act = _stand_still
_others: Act = _stand_still


def _link(now: Situation, action: NDArray[np.float32]) -> None:
    if now.agents.robot[now.seat] // 10 == _KIND:
        _act(now, action)
    else:
        _others(now, action)


def chain(kinds: Iterable[tuple[Robot, ...]]) -> Act:
    """Return the kernel that lets the robot in a seat decide, of the robots of each kind by level."""
    links = list(kinds)
    _check_distinct([robot for levels in links for robot in levels])
    decide: Act = _stand_still
    for number, levels in reversed(list(enumerate(links))):
        make = kernel if number == 0 else inlined_kernel
        decide = make(_linked(levels[0], decide))
    return decide


def _linked(robot: Robot, others: Act) -> Callable[[Situation, NDArray[np.float32]], None]:
    """Return the function of one link, with its own name for the cache of compiled code."""
    kind = robot.number // 10
    values = {"_KIND": kind, "_act": robot.act, "_others": others}
    name = f"decide_{kind}"
    link = FunctionType(_link.__code__.replace(co_name=name, co_qualname=name), {**globals(), **values}, name)
    link.__doc__ = "Write the action of the robot in a seat for the coming step into a row of zeros."
    return link


def _check_distinct(robots: list[Robot]) -> None:
    for attribute in ("name", "number"):
        by_value: dict[str | int, Robot] = {}
        for robot in robots:
            first = by_value.setdefault(getattr(robot, attribute), robot)
            if first is not robot:
                raise ExtensionError(
                    f"the robots {first.name!r} and {robot.name!r} have the same {attribute}; uninstall the "
                    "package of one of them"
                )


ROBOTS = {robot.name: robot for levels in KINDS.values() for robot in levels}
decide = chain(KINDS.values())
