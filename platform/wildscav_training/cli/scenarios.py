"""``wildscav baselines --scenario``: what agents reach in held-out company."""

from collections.abc import Sequence
from functools import partial
from statistics import fmean
from typing import TYPE_CHECKING

from wildscav.errors import UserError
from wildscav_training.cli.playing import ALL, baselines_of, play_all, players_of, refusal

if TYPE_CHECKING:
    from wildscav_training.cli.playing import Played
    from wildscav_training.trials import Trial

NORMALIZED = "normalized"


def play_scenarios(name: str, track: str | None, agents: Sequence[str] | None, matches: int) -> "Played":
    """Let agents, or all baselines, play a scenario or all those on a track.

    Returns:
        Their trials with normalized scores, and those of their means over all scenarios.

    Raises:
        UserError: No scenario is on the track, there is no such agent, or it plays none of the scenarios.
    """
    from wildscav_training.company.scenarios import (
        RANDOM,
        REFERENCE,
        SCENARIOS,
        company_of,
        matches_of,
        play_in,
    )

    named = SCENARIOS if name == ALL else {name: SCENARIOS[name]}
    chosen = {key: scenario for key, scenario in named.items() if track in (None, scenario.track)}
    if not chosen:
        played_on = ", ".join(dict.fromkeys(scenario.track for scenario in named.values()))
        raise UserError(f"--track is {track}, but --scenario {name} is played on {played_on}", exit_code=2)
    tracks = tuple(dict.fromkeys(scenario.track for scenario in chosen.values()))
    shown = players_of(
        tracks, agents or dict.fromkeys(agent for each in tracks for agent in baselines_of(each))
    )
    company = company_of(chosen.values())
    yardsticks = {agent: company[agent] for agent in (RANDOM, REFERENCE)}
    players = {
        key: {agent: player for agent, player in shown.items() if not refusal(player, scenario.track)}
        | yardsticks
        for key, scenario in chosen.items()
    }
    each = (
        ((key, agent), partial(play_in, scenario, player, company, spec))
        for key, scenario in chosen.items()
        for spec in matches_of(scenario, matches)
        for agent, player in players[key].items()
    )
    played = play_all(each, matches * sum(map(len, players.values())))
    scored = {place: _scored(played, *place) for place in played if place[1] in shown}
    return scored | dict(_mean(scored, agent) for agent in shown)


def _scored(played: "Played", scenario: str, agent: str) -> "list[Trial]":
    """Return trials with the scores of random and the reference, and the normalized one if it can be told."""
    from wildscav_training.company.scenarios import RANDOM, REFERENCE, SCORE, normalized

    trials = played[scenario, agent]
    scores = {
        head: [trial.metrics[SCORE] for trial in played[scenario, name]]
        for head, name in ((SCORE, agent), ("random", RANDOM), ("reference", REFERENCE))
    }
    told = normalized(*scores.values())
    columns = scores | ({NORMALIZED: told} if told else {})
    return [
        trial._replace(metrics={**trial.metrics, **dict(zip(columns, row, strict=True))})
        for trial, row in zip(trials, zip(*columns.values(), strict=True), strict=True)
    ]


def _mean(scored: "Played", agent: str) -> "tuple[tuple[str, str], list[Trial]]":
    """Return the means of an agent's normalized scores, match by match, since scenarios share their maps."""
    rows = [
        trials for (_, name), trials in scored.items() if name == agent and NORMALIZED in trials[0].metrics
    ]
    means = [
        trials[0]._replace(metrics={NORMALIZED: fmean(trial.metrics[NORMALIZED] for trial in trials)})
        for trials in zip(*rows, strict=True)
    ]
    return (f"mean of {len(rows)}", agent), means
