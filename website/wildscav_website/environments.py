"""One page for each environment: its observations, actions and rewards, generated from the code."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from gymnasium.spaces import Box, Dict, Discrete, MultiDiscrete, Space

from wildscav_engine.envs import PRESETS
from wildscav_engine.envs.batched import multi_agent_config
from wildscav_engine.envs.registry import env_id, zoo_id
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.single import single_agent_config
from wildscav_engine.envs.spaces.actions import ActionMode, action_mode
from wildscav_engine.envs.spaces.global_state import global_state_space
from wildscav_engine.envs.spaces.observation import readings_space
from wildscav_engine.tracks import TRACKS, Track
from wildscav_engine.tracks.rewards import REWARD_TERMS
from wildscav_website.links import ROOT
from wildscav_website.markdown import code, indented, number, sentence, table
from wildscav_website.observed import Row, observation_rows
from wildscav_website.references.sdk import fields_of

MODES = ("dict", "box", "baseline", "multidiscrete", "fine", "keys")
ACTIONS = """## Action space

An action is held for all frames of a step. The option `action_mode` chooses its format; the default here is
`{default}`.
"""
OBSERVATIONS = """## Observation space

An observation is a Dict of Boxes of float32 with the names and bounds below. With `flat=True` it is one row
of numbers, each divided by its usual magnitude; the index is the number's place in that row. Positions are in
world axes: x east, y up, z north.

In version 0, `to_target`, `to_box` and `to_enemy` are missing, and flat rows contain a tenth of the sines and
cosines of `view`.
"""
REWARDS = """## Rewards

The reward of a step is the sum of these terms, each times its weight. `info["reward_terms"]` contains the
contribution of each.
"""
OTHER_TERMS = """The option `rewards` replaces them with a table of weights by the names of terms.

??? note "All other terms"
"""
METRICS = """## Metrics

`info["metrics"]` contains these in the last step of an episode. The first is the score in competitions.
Those that take long to measure, such as SPL, are there with `all_metrics=True`.
"""
ARGUMENTS = """## Arguments

These are keyword arguments of `gymnasium.make` and of all other functions that make this environment. The
guide explains [options](../environments.md#options), [opponents](../environments.md#opponents) and
[actions](../environments.md#actions).
"""


class Environment(NamedTuple):
    """An environment that has a page."""

    name: str  # of its page: the name of the track or of the preset
    track: Track
    options: Mapping[str, Any]  # with which it is made

    @property
    def single(self) -> EnvConfig:
        """The config for one learner."""
        return single_agent_config(self.track.name, self.options)

    @property
    def several(self) -> EnvConfig:
        """The config for several learners."""
        return multi_agent_config(self.track.name, self.options)


def environments() -> list[Environment]:
    """Return all environments: the tracks, then the presets."""
    tracks = [Environment(name, track, {}) for name, track in TRACKS.items()]
    return [
        *tracks,
        *(Environment(name, TRACKS[track], {"preset": name}) for name, (track, _) in PRESETS.items()),
    ]


def pages() -> dict[str, Callable[[], str]]:
    """Return a function for each page, which writes it, by its path on the website."""
    return {f"environments/{one.name}.md": partial(page, one) for one in environments()}


def link_to_pages(markdown: str) -> str:
    """Return the guide with a link from every id and preset to its page."""
    for one in environments():
        known = env_id(one.track.name) if one.name == one.track.name else one.name
        markdown = markdown.replace(f"`{known}`", f"[`{known}`](environments/{one.name}.md)", 1)
    return markdown


def page(one: Environment) -> str:
    """Return the page of an environment."""
    parts = [_opening(one), _task(one), _actions(one), _observations(one), _rewards(one), _ends(one)]
    return "\n".join([*parts, _measured(one), _arguments(one)])


def title_of(one: Environment) -> str:
    """Return the heading of a page."""
    title = one.track.name.capitalize()
    return title if one.name == one.track.name else f"The paper's {title.lower()}"


def _opening(one: Environment) -> str:
    track, single, several = one.track.name, one.single, one.several
    more = "".join(f", {name}={value!r}" for name, value in one.options.items())
    parallel = f"parallel_env({track!r}{more})"
    mode = action_mode(single)
    observed = observation_rows(single)
    rows = [
        ("Gymnasium", code(f'gymnasium.make("wildscav_engine:{env_id(track)}"{more})')),
        ("PettingZoo", f"{code(parallel)}, registered as {code(zoo_id(track))}"),
        ("Action space", f"{code(_written(mode.space))}, by default"),
        ("Observation space", code(_written(readings_space(single)))),
        ("Numbers of an observation", f"{observed[-1].indexes.stop} with `flat=True`"),
        (
            "State of the whole match",
            f"{code(_written(global_state_space(several)))}: PettingZoo's `state()`",
        ),
        ("Learners", f"1 with Gymnasium, {several.agents} with PettingZoo, by default"),
        ("Other seats", _others(single)),
        ("Episode", _length(single)),
    ]
    return f"# {title_of(one)}\n\n{_picture(one.track.name)}\n" + table(("", ""), rows)


def _picture(track: str) -> str:
    name = f"images/environments/{track}.jpg"
    if not (ROOT / "docs" / name).exists():
        return ""
    return f"![What a learner sees, and the match from above](../{name})\n"


def _others(config: EnvConfig) -> str:
    mates, robots = config.teammates, config.all_opponents
    if not mates and not robots:
        return "none"
    told = [(mates, "on the learner's team"), (robots, "against it")]
    return ", ".join(f"{len(names)} × {code(names[0])} {where}" for names, where in told if names)


def _length(config: EnvConfig) -> str:
    spec = config.match_spec()
    steps = -(-round(spec.time_limit * 50) // spec.frames_per_action)
    held = f"{spec.frames_per_action} frames of 1/50 s each"
    return f"{spec.time_limit:g} s of game time: {steps:,} steps at most, {held}"


def _task(one: Environment) -> str:
    task, score = _row_of_readme(one.track.name)
    text = f"{sentence(task)} The score of a match: {sentence(score)}\n"
    if one.options:
        settings = PRESETS[one.name][1]
        text += "\nThis is the set-up of the paper's experiment, equal to these options:\n\n"
        text += table(("option", "value"), ((code(name), code(value)) for name, value in settings.items()))
    return f"## The task\n\n{text}\n[The rules](../rules.md) describe everything else, with all numbers.\n"


def _row_of_readme(track: str) -> tuple[str, str]:
    """Return what the README says of a track: the task, and the score."""
    text = (ROOT / "README.md").read_text("utf-8")
    found = re.search(rf"^\| {track} \| (.+) \| (.+) \|$", text, re.MULTILINE)
    if found is None:
        raise LookupError(f"README.md has no row about the track {track}")
    return found[1], found[2]


def _actions(one: Environment) -> str:
    default = one.single.action_mode
    lines = [ACTIONS.format(default=default)]
    for name in sorted(MODES, key=lambda name: name != default):
        config = single_agent_config(one.track.name, {**one.options, "action_mode": name})
        lines.append(f'=== "{name}"\n')
        lines.append(indented("\n".join(_mode(action_mode(config)))))
    return "\n".join(lines)


def _mode(mode: ActionMode) -> Iterator[str]:
    yield f"`{_written(mode.space)}`\n"
    rows = (
        (
            str(place),
            code(column.name),
            column.meaning,
            column.unit,
            number(column.low),
            number(column.high),
        )
        for place, column in enumerate(mode.columns)
    )
    yield table(("no.", "name", "meaning", "unit", "min", "max"), rows)
    choices = mode.describe().get("table")
    if choices:
        yield '??? note "The list of choices"\n'
        yield indented(_choices(choices))


def _choices(rows: list[list[float]]) -> str:
    picks = any(row[5] for row in rows)
    head = ("choice", "direction, degrees", "speed, m/s", *(("pick up",) if picks else ()))
    return table(
        head,
        (
            (str(place), f"{row[0]:g}", f"{row[1]:g}", *(("yes" if row[5] else "no",) if picks else ()))
            for place, row in enumerate(rows)
        ),
    )


def _observations(one: Environment) -> str:
    single, several = observation_rows(one.single), observation_rows(one.several)
    lines = [OBSERVATIONS]
    if single == several:
        return "\n".join([*lines, _observed(single)])
    for name, rows in (("One learner (Gymnasium)", single), ("Several learners (PettingZoo)", several)):
        lines += [f'=== "{name}"\n', indented(_observed(rows))]
    return "\n".join(lines)


def _observed(rows: list[Row]) -> str:
    return table(
        ("index", "name", "meaning", "unit", "min", "max"),
        (
            (
                _indexes(row.indexes),
                code(f"{row.part}[{row.place}]"),
                f"{row.column.name}: {row.column.meaning}"
                if row.column.name != row.part
                else row.column.meaning,
                row.column.unit,
                number(row.column.low),
                number(row.column.high),
            )
            for row in rows
        ),
    )


def _indexes(indexes: range) -> str:
    if len(indexes) == 1:
        return str(indexes[0])
    if indexes.step == 1:
        return f"{indexes[0]} to {indexes[-1]}"
    return (
        f"{indexes[0]}, {indexes[1]}, … {indexes[-1]}" if len(indexes) > 2 else f"{indexes[0]}, {indexes[1]}"
    )


def _rewards(one: Environment) -> str:
    weights = one.single.reward_weights
    rows = ((code(name), f"{weight:g}", REWARD_TERMS[name].title) for name, weight in weights.items())
    others = ((code(name), term.title) for name, term in REWARD_TERMS.items() if name not in weights)
    paid = table(("term", "weight", "what it counts"), rows)
    return "\n".join([REWARDS, paid, OTHER_TERMS, indented(table(("term", "what it counts"), others))])


def _ends(one: Environment) -> str:
    track = one.track
    reasons = {
        "the target is reached": track.has_target,
        "a team carries as many supplies as the option `supply_goal` says": track.has_supply_goal,
        "one team is left": not track.respawns,
        "the learner dies, since the dead do not respawn": not track.respawns,
    }
    happens = [f"- {reason}" for reason, holds in reasons.items() if holds]
    ended = (
        ["An episode is *terminated* when\n", *happens, ""]
        if happens
        else ["Nothing *terminates* an episode.\n"]
    )
    return "\n".join(["## End of an episode\n", *ended, "It is *truncated* when the time is up.\n"])


def _measured(one: Environment) -> str:
    rows = (
        (code(metric.name), metric.title, metric.unit, "less" if metric.lower_is_better else "more")
        for metric in one.track.metrics + one.track.slow_metrics
    )
    return f"{METRICS}\n{table(('metric', 'what it is', 'unit', 'better'), rows)}"


def _arguments(one: Environment) -> str:
    """Describe every option with its value here and the meaning that is told beside it."""
    preset = ("`preset`", code(one.options.get("preset", "")) or "none", "options to start from, by name")
    rows = (
        (code(field.name), _default(one.single, field.name), field.meaning)
        for field in fields_of(EnvConfig)
        if field.name != "track"
    )
    return f"{ARGUMENTS}\n{table(('argument', 'default here', 'what it is'), [preset, *rows])}"


def _default(config: EnvConfig, name: str) -> str:
    """Return the default value of an option in an environment."""
    found: dict[str, Any] = {
        "time_limit": f"{config.match_spec().time_limit:g} s",
        "opponents": _several(config.all_opponents),
        "teammates": _several(config.teammates),
        "sensors": ", ".join(config.read_sensors()),
        "rewards": ", ".join(f"{term}: {weight:g}" for term, weight in config.reward_weights.items()),
        "rules": "`Rules()`",
    }
    return str(found[name]) if name in found else code(repr(getattr(config, name)))


def _several(names: Sequence[object]) -> str:
    return f"{len(names)} × {code(names[0])}" if names else "none"


def _written(space: Space[Any]) -> str:
    """Return a space in a line."""
    if isinstance(space, Dict):
        return f"Dict({', '.join(f'{name}: {_written(one)}' for name, one in space.spaces.items())})"
    if isinstance(space, Discrete):
        return f"Discrete({space.n})"
    if isinstance(space, MultiDiscrete):
        return f"MultiDiscrete({space.nvec.tolist()})"
    if isinstance(space, Box):
        low, high = {float(one) for one in space.low.flat}, {float(one) for one in space.high.flat}
        bounds = f"{number(*low)}, {number(*high)}" if len(low) == len(high) == 1 else "…"
        return f"Box({bounds}, {space.shape}, {space.dtype})"
    raise TypeError(f"{space} is of an unknown kind")
