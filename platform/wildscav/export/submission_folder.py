"""The files of a submission that plays a trained policy."""

import json
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from wildscav.export.trained_model import TrainedModel
from wildscav.policy.networks import Choose
from wildscav.policy.policy import FILE

TEMPLATE = ("agent.py", "README.md")


def submission_files(
    trained: TrainedModel, tables: Mapping[str, Any], name: str, choose: Choose
) -> dict[str, bytes]:
    """Return the files of a submission: their contents by name.

    Args:
        trained: The model.
        tables: What ``policy_tables`` returned.
        name: Name of the submission.
        choose: How it selects actions from the network's outputs.
    """
    policy = {"choose": choose.value, "network": tables["network"], "environment": tables["environment"]}
    template = files("wildscav.export") / "template"
    texts = {file: (template / file).read_text("utf-8") for file in TEMPLATE}
    written = {
        "submission.toml": _manifest(tables["environment"], name),
        FILE: json.dumps(policy, indent=1) + "\n",
        **{file: text.replace("my-agent", name) for file, text in texts.items()},
    }
    if trained.requirements:
        written["requirements.txt"] = "".join(f"{line}\n" for line in trained.requirements)
    return {**{file: text.encode() for file, text in written.items()}, **trained.files}


def _manifest(environment: Mapping[str, Any], name: str) -> str:
    lines = [
        f"name = {json.dumps(name)}",
        'version = "0.1.0"',
        'entry_point = "agent:TrainedAgent"',
        f"tracks = [{json.dumps(environment['track'])}]",
    ]
    for part in environment["observations"]:
        if "sensor" in part:
            # Numbers, strings, booleans and lists of them are written in TOML as in JSON.
            options = {key: value for key, value in part["sensor"].items() if value is not None}
            lines += ["", f"[sensors.{part['name']}]"]
            lines += [f"{key} = {json.dumps(value)}" for key, value in options.items()]
    return "\n".join(lines) + "\n"
