"""``wildscav init``: a new submission, from a template or from a trained policy, ready to play."""

import re
import shlex
from collections.abc import Mapping
from importlib.metadata import entry_points
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from wildscav.baselines import NAMES, baseline_folder
from wildscav.errors import UserError

TEMPLATE = ("submission.toml", "agent.py", "README.md")
LONGEST_NAME = 40  # characters
CHOOSE, ACTIVATION = "sampled", "tanh"  # by default
POLICY_FILES = "wildscav.policy_files"  # entry points: functions such as that of wildscav_training


Folder = Annotated[
    Path, typer.Argument(help="Folder to create: one that does not exist yet, or an empty one.")
]
Name = Annotated[str | None, typer.Option(help="Name of the submission. Default: the name of the folder.")]
Baseline = Annotated[
    str | None,
    typer.Option(
        "--from", help=f"Start from a copy of a baseline: {', '.join(NAMES)}. Default: a small template."
    ),
]
PolicyFile = Annotated[
    Path | None,
    typer.Option(
        help="A trained policy to play: a .zip of Stable-Baselines3 (only one that you trust: it contains "
        "Python objects), an .onnx file, or an .npz of layers."
    ),
]
Track = Annotated[str | None, typer.Option(help="With --from-policy: the track that it was trained for.")]
EnvironmentOptions = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=VALUE",
        help="With --from-policy: an option of the environment that it was trained in, its value as "
        "JSON, such as frames_per_action=15. Options that the policy's shapes determine may be left out.",
    ),
]
Choosing = Annotated[
    str,
    typer.Option(
        help="With --from-policy: sampled (with the policy's probabilities) or deterministic (the likeliest)."
    ),
]
Activation = Annotated[str, typer.Option(help="With an .npz: the activation after each layer but the last.")]


def init(
    folder: Folder,
    name: Name = None,
    baseline: Baseline = None,
    from_policy: PolicyFile = None,
    track: Track = None,
    option: EnvironmentOptions = None,
    choose: Choosing = CHOOSE,
    activation: Activation = ACTIVATION,
) -> None:
    """Create a new submission from a template, a baseline or a trained policy, ready to play."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise UserError(f"{folder} is not an empty folder: name one that does not exist yet", exit_code=2)
    name = submission_name(folder.resolve().name) if name is None else _checked(name)
    if from_policy is None and (track is not None or option or (choose, activation) != (CHOOSE, ACTIVATION)):
        raise UserError("--track, --option, --choose and --activation are for --from-policy", exit_code=2)
    if from_policy is not None and baseline is not None:
        raise UserError(
            "--from and --from-policy are both given: start from a baseline or a policy", exit_code=2
        )
    if baseline is not None:
        content = _from_baseline(baseline, name)
    elif from_policy is None:
        content = _from_template(name)
    else:
        content = _from_policy(from_policy, name, track, option or [], choose, activation)
    write_files(folder, content)
    _print_next_steps(folder, name)


def _print_next_steps(folder: Path, name: str) -> None:
    from rich.text import Text

    from wildscav.terminal.console import console

    console.print(Text.assemble((str(folder), "bold"), " holds a new agent, ", (name, "bold"), ". Next:"))
    quoted = shlex.quote(str(folder))
    for command, what in (
        (f"wildscav play {quoted}", "one match"),
        (f"wildscav check {quoted}", "everything that an evaluation requires"),
        (f"wildscav evaluate {quoted}", "its scores"),
    ):
        console.print(f"  {command}  # {what}")
    console.print("To take part in a season, whose organizers give you its address and a key:")
    for command, what in (
        ("wildscav login URL --register --invitation KEY", "an account (KEY if needed)"),
        ("wildscav team create NAME", "or join one: wildscav team join KEY"),
        (f"wildscav submit {quoted} --wait", "hand it in"),
    ):
        console.print(f"  {command}  # {what}")
    console.print(f"The agent's code is in {folder / 'agent.py'}.")


def _from_baseline(baseline: str, name: str) -> dict[str, bytes]:
    """Return the files of a baseline, with its name replaced."""
    folder = baseline_folder(baseline)
    content = {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}
    old, new = (f'name = "{each}"'.encode() for each in (folder.name, name))
    return content | {"submission.toml": content["submission.toml"].replace(old, new)}


def _from_policy(*arguments: object) -> dict[str, bytes]:
    """Return the files of a submission that plays a policy, made by the package that can read one."""
    for point in entry_points(group=POLICY_FILES):
        content: dict[str, bytes] = point.load()(*arguments)
        return content
    raise UserError("--from-policy needs training: pip install 'wildscav[training]'")


def _from_template(name: str) -> dict[str, bytes]:
    template = files("wildscav.cli") / "template"
    texts = {file: (template / file).read_text("utf-8").replace("my-agent", name) for file in TEMPLATE}
    # The comments on commands stand below each other, however long the name is.
    width = 58 + len(name)
    texts["README.md"] = re.sub(
        r"^(    .*\S) +# (.*)$",
        lambda line: f"{line[1]:<{width}}# {line[2]}",
        texts["README.md"],
        flags=re.MULTILINE,
    )
    return {file: text.encode() for file, text in texts.items()}


def write_files(folder: Path, content: Mapping[str, bytes]) -> None:
    """Write all files into a folder, or none."""
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    try:
        for file, data in content.items():
            (folder / file).write_bytes(data)
    except OSError:
        for file in content:
            (folder / file).unlink(missing_ok=True)
        if is_new:
            folder.rmdir()
        raise


def submission_name(text: str) -> str:
    """Return a valid submission name that is close to a text."""
    name = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:LONGEST_NAME].rstrip("-")
    return name if len(name) > 1 else "my-agent"


def _checked(name: str) -> str:
    if not re.fullmatch(rf"[a-z0-9][a-z0-9-]{{1,{LONGEST_NAME - 1}}}", name):
        raise UserError(
            f"--name is {name!r}, must be 2 to {LONGEST_NAME} of a-z, 0-9 and -, a letter or digit first",
            exit_code=2,
        )
    return name
