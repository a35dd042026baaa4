"""The command ``wildscav price``."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.shared_options import takes
from wildscav.errors import UserError
from wildscav_evaluator.cli.options.evaluation import PlayOptions, RoundsOption


@takes(PlayOptions)
def price(
    options: PlayOptions,
    agent: Annotated[
        Path, typer.Argument(help="A submission, or a baseline, as for evaluate.", metavar="AGENT")
    ],
    track: Annotated[
        str | None,
        typer.Option(help="The track to play. Default: the first of the agent's that the suite has."),
    ] = None,
    paces: Annotated[
        str, typer.Option(help="The paces at which to play, in game seconds a second, separated by commas.")
    ] = "0.5,1,2,4,8",
    rounds: RoundsOption = 2,
    think: Annotated[
        float, typer.Option(help="Seconds by which to slow down every decision on purpose.", min=0.0)
    ] = 0.0,
) -> None:
    """Measure the price of thinking: play the same matches paused and at several paces.

    At a pace, the world goes on while the agent thinks. The score is drawn over the delay, the game time that
    passes during a decision, with 95 % intervals. The same command continues what was interrupted.

    With --json: `folder`, and what price.json has: `format`, `versions`, `submission`, `version`, `digest`,
    `interface`, `think` (of --think), `track`, `suite`, `seed`, `rounds`, `sandbox`, `limits`, `model`,
    `metric`, and `points`: `clock`, `thinking`, `delay`, `score`, `matches` and `faults` of each.
    """
    from wildscav_evaluator.cli.options.selection import load_named, suite_tracks
    from wildscav_evaluator.cli.sessions.price import clocks_of, run_price, thinking_longer
    from wildscav_evaluator.output.numbered_folders import OUT
    from wildscav_evaluator.plans.evaluation import EvaluationPlan

    if options.clock is not None:
        raise UserError("price chooses the clocks itself: give --paces instead of --clock", 2)
    clocks, suite = clocks_of(paces), options.find_suite()
    with thinking_longer(load_named(agent), think) as submission:
        tracks = suite_tracks((submission,), [track] if track else [], suite)[:1]
        out = options.out or OUT / "price" / f"{submission.name}-{tracks[0]}"
        with replace(options, out=out).planned(
            EvaluationPlan, (submission,), out, suite=suite, tracks=tracks, rounds=rounds, replays="none"
        ) as (plan, machines):
            run_price(plan, clocks, options.monitor, machines, think=think, as_json=options.as_json)
