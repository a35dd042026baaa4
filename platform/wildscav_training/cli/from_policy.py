"""``wildscav init --from-policy``: from its options to the files of the submission."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from wildscav.errors import UserError
from wildscav.policy.networks import Choose


def policy_files(
    model: Path, name: str, track: str | None, options: Sequence[str], choose: str, activation: str
) -> dict[str, bytes]:
    """Return the files of a submission that plays a trained policy, by name.

    Args:
        track: The track that the policy was trained for; not needed if the options name a preset.
        options: Options of the environment, each as NAME=VALUE.

    Raises:
        UserError: The policy cannot be read, or does not fit the environment.
    """
    from wildscav_training.export import policy_tables, read_model, submission_files

    if choose not in list(Choose):
        raise UserError(f"--choose is {choose!r}, must be {' or '.join(Choose)}", exit_code=2)
    given = dict(map(read_option, options))
    trained = read_model(model, activation)
    tables = policy_tables(trained, _track(track, given), given)
    return submission_files(trained, tables, name, Choose(choose))


def read_option(text: str, option: str = "--option") -> tuple[str, Any]:
    """Return the name and the value of NAME=VALUE, which is JSON or a word, or raise a UserError."""
    name, equals, value = text.partition("=")
    if not equals or not name:
        example = "frames_per_action=15" if option == "--option" else "entropy=0.01"
        raise UserError(f"{option} is {text!r}, must be NAME=VALUE, such as {example}", exit_code=2)
    try:
        return name, json.loads(value)
    except ValueError:
        return name, value  # a word needs no quotes


def _track(track: str | None, options: dict[str, Any]) -> str:
    from wildscav_engine.envs import PRESETS

    if track is not None:
        return track
    preset = options.get("preset")
    if isinstance(preset, str) and preset in PRESETS:
        return PRESETS[preset][0]
    raise UserError("--track is missing: name the track that the policy was trained for", exit_code=2)
