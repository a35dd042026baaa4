"""The environment that a model was trained in: its options, checked against the model's shapes."""

import math
from collections.abc import Mapping
from typing import Any

from wildscav.errors import UserError
from wildscav.policy.action_choice import ACTIONS, NUMBERS, SCORES
from wildscav.policy.action_modes import ActionMode, action_mode
from wildscav_training.export.trained_model import Shape, TrainedModel

MODES = ("multidiscrete", "fine", "baseline", "box")  # the action modes that a network can play


def policy_tables(trained: TrainedModel, track: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the environment that a model was trained in, and the meaning of the model's outputs.

    Args:
        options: Options of the environment. ``flat``, ``action_mode`` and ``version`` are inferred from the
            model if they are not given.

    Returns:
        The tables "environment" and "network" of ``policy.json``.

    Raises:
        UserError: The options are wrong, or the model does not fit them.
    """
    given = {"flat": not isinstance(trained.inputs, Mapping), **options}
    modes = (given["action_mode"],) if "action_mode" in given else MODES
    fitting = []
    for mode in modes:
        description = _of_fitting_version(trained, track, {**given, "action_mode": mode})
        head = _head(trained, action_mode(description["actions"]))
        if head is not None:
            fitting.append((description, head))
    if len(fitting) != 1:
        raise UserError(_modes_error(trained, track, modes, len(fitting)), exit_code=2)
    description, head = fitting[0]
    stack = _stack(trained, description)
    return {
        "environment": description | ({} if stack is None else {"stack": stack}),
        "network": {**trained.network, "head": head},
    }


def _of_fitting_version(trained: TrainedModel, track: str, options: dict[str, Any]) -> dict[str, Any]:
    """Return the environment in the oldest version whose observations the model takes."""
    from wildscav_engine.envs.registry import VERSIONS

    if "version" in options:
        return _describe(track, options)
    versions = [_describe(track, {**options, "version": version}) for version in VERSIONS]
    return next((one for one in versions if None not in _stacks(trained, one)), versions[-1])


def _describe(track: str, options: dict[str, Any]) -> dict[str, Any]:
    from wildscav_engine.envs import describe
    from wildscav_engine.envs.batched import multi_agent_config
    from wildscav_engine.envs.single import single_agent_config

    try:
        several = options.get("agents", 1) != 1
        return describe(
            multi_agent_config(track, options) if several else single_agent_config(track, options)
        )
    except (TypeError, ValueError) as error:
        raise UserError(f"the options of the environment: {error}", exit_code=2) from None


def _head(trained: TrainedModel, mode: ActionMode) -> str | None:
    """Return the meaning of a model's outputs in an action mode; None if they do not fit it."""
    if trained.head is not None:
        same = trained.sizes == mode.sizes and bool(trained.sizes or mode.numbers)
        deviations = trained.network.get("deviations")
        return trained.head if same and (deviations is None or len(deviations) == mode.numbers) else None
    if trained.outputs is None or not (mode.sizes or mode.numbers):
        return None
    if trained.outputs_are_integers:
        return ACTIONS if mode.sizes and trained.outputs == len(mode.sizes) else None
    if mode.sizes:
        return SCORES if trained.outputs == sum(mode.sizes) else None
    return NUMBERS if trained.outputs == mode.numbers else None


def _modes_error(trained: TrainedModel, track: str, modes: tuple[str, ...], fitting: int) -> str:
    outputs = f"chooses from {list(trained.sizes)}" if trained.sizes else f"returns {trained.outputs} numbers"
    if trained.outputs is None and not trained.sizes:
        outputs = "does not specify how many numbers it returns"
    names = ", ".join(modes)
    if fitting:
        return (
            f"{trained.source} {outputs}, which fits several action modes: name one, such as "
            "--option action_mode=box"
        )
    return f"{trained.source} {outputs}, which does not fit the track {track} with action_mode {names}"


def _stack(trained: TrainedModel, description: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return how many observations the model takes at once, and how they are stacked."""
    shapes, wanted = _shapes(description), trained.inputs
    if isinstance(wanted, Mapping) and (missing := sorted(set(wanted) - set(shapes))):
        raise UserError(
            f"{trained.source} takes {missing[0]!r}; the environment with these options returns "
            f"{', '.join(shapes)}: give the sensors, --option 'sensors={{…}}'",
            exit_code=2,
        )
    found = _stacks(trained, description)
    if len(found) == 1 and (stack := found.pop()) is not None:
        count, axis = stack
        padding = "zero" if axis == "last" else "first"
        return None if count == 1 else {"count": count, "axis": axis, "padding": padding}
    parts = ", ".join(f"{name} {list(shape)}" for name, shape in shapes.items())
    raise UserError(
        f"{trained.source} takes {_shown(wanted)}; the environment with these options returns {parts}, "
        f"{sum(math.prod(shape) for shape in shapes.values())} numbers: give the options used in training, "
        'such as --option \'sensors={"depth": {"width": 10, "height": 10}}\'',
        exit_code=2,
    )


def _shapes(description: Mapping[str, Any]) -> dict[str, Shape]:
    return {str(part["name"]): tuple(part["shape"]) for part in description["observations"]}


def _stacks(trained: TrainedModel, description: Mapping[str, Any]) -> set[tuple[int, str] | None]:
    """Return how each of a model's inputs stacks an environment's observations; None if it does not fit."""
    shapes, wanted = _shapes(description), trained.inputs
    if isinstance(wanted, Mapping):
        return {_ratio(shape, shapes[name]) if name in shapes else None for name, shape in wanted.items()}
    return {_ratio(wanted, (sum(math.prod(shape) for shape in shapes.values()),))}


def _ratio(wanted: Shape, single: Shape) -> tuple[int, str] | None:
    """Return how many arrays of one shape stack to another, and along which axis; None if they do not."""
    if wanted == single:
        return 1, "last"
    if wanted[1:] == single and wanted[0] > 1:
        return wanted[0], "new"
    last = single[-1]
    if len(wanted) == len(single) and wanted[:-1] == single[:-1] and wanted[-1] % last == 0:
        return wanted[-1] // last, "last"
    return None


def _shown(wanted: Mapping[str, Shape] | Shape) -> str:
    if isinstance(wanted, Mapping):
        return ", ".join(f"{name} {list(shape)}" for name, shape in wanted.items())
    return f"{math.prod(wanted)} numbers" if len(wanted) == 1 else f"an array {list(wanted)}"
