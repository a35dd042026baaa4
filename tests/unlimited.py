"""Functions that run in the process of the tests, and elsewhere in one with limits, which takes a while."""

import operator
from importlib import import_module
from typing import Any


def call_here(function: str, *arguments: Any, memory: int = 0) -> Any:
    """Call a function as ``call_limited`` does, without limits."""
    module, _, name = function.partition(":")
    return operator.attrgetter(name)(import_module(module))(*arguments)
