"""Shortcuts through work that Numba repeats, which takes a quarter of the time of its compilations.

They hold only while a kernel is being compiled, and what is compiled stays the same. Like ``linking.py``,
this relies on internals of Numba.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import errors, event, ir, targetconfig
from numba.core.types import functions
from numba.core.typing import templates

from wildscav_engine.compilation.linking import BitcodeCompiler

# Annotated as Any, because Numba has no types for them.
Variable: Any = ir.Var
Instruction: Any = ir.Inst
Config: Any = targetconfig.TargetConfig
ConfigStack: Any = targetconfig.ConfigStack
Overloads: Any = templates._OverloadFunctionTemplate
FunctionType: Any = functions.BaseFunction
find_type: Any = FunctionType.get_call_type
find_decorator: Any = Overloads._get_jit_decorator

_found: dict[Any, Any] = {}  # the signature and implementation of calls of Numba's own functions, by types


def _type_of_call(function: Any, context: Any, arguments: Any, keywords: Any) -> Any:
    """Return the signature of a call. Numba asks for the same ones again for every operator of a kernel."""
    key = function, tuple(arguments), tuple(dict(keywords).items()), ConfigStack.top_or_none()
    if key not in _found:
        signature = find_type(function, context, arguments, keywords)
        _found[key] = signature, function._impl_keys[signature.args]
    signature, function._impl_keys[signature.args] = _found[key]
    return signature


def _options(config: Any) -> dict[str, Any]:
    """Return all options of a function. Numba compares them whenever it looks up something compiled."""
    return {name: config._values.get(name, option.default) for name, option in config.options.items()}


def _variables_in(instruction: Any, value: Any) -> list[Any]:
    """Return the variables in a part of an instruction. Most parts are constants or places in the source."""
    if isinstance(value, Variable):
        return [value]
    if isinstance(value, Instruction):
        return list(value.list_vars())
    if isinstance(value, dict):
        value = value.values()
    elif not isinstance(value, list | tuple):
        return []
    return [variable for part in value for variable in _variables_in(instruction, part)]


def _decorator_of_parts(overloads: Any) -> Any:
    """Return what compiles Numba's own functions: as parts, which are linked into what calls them."""
    decorator = find_decorator(overloads)
    return lambda **options: decorator(pipeline_class=BitcodeCompiler, no_cfunc_wrapper=True, **options)


def _if_heard(report: Any) -> Any:
    """Return what reports an event if anybody listens. Every call of LLVM is two events."""

    def report_if_heard(kind: str, **details: Any) -> None:
        if event._registered[kind]:
            report(kind, **details)

    return report_if_heard


@contextmanager
def _untimed(*_: Any) -> Iterator[None]:
    """Listen to no events to time the compilation."""
    yield


def _unmarked(_: Any, text: str) -> str:
    """Return a message without colours. Numba makes and discards several for every function."""
    return text


SHORTCUTS = (
    (FunctionType, "get_call_type", _type_of_call),
    (Config, "values", _options),
    (Instruction, "_rec_list_vars", _variables_in),
    (Overloads, "_get_jit_decorator", _decorator_of_parts),
    (event, "start_event", _if_heard(event.start_event)),
    (event, "end_event", _if_heard(event.end_event)),
    (event, "install_timer", _untimed),
    (type(errors.termcolor()), "errmsg", _unmarked),
)


@contextmanager
def shortcuts() -> Iterator[None]:
    """Take the shortcuts."""
    before = [(owner, name, getattr(owner, name)) for owner, name, _ in SHORTCUTS]
    for owner, name, shortcut in SHORTCUTS:
        setattr(owner, name, shortcut)
    try:
        yield
    finally:
        for owner, name, original in before:
            setattr(owner, name, original)
