"""Whether people have a chance against robots: a model of one in the matches of ``wildscav human``.

    python -m benchmarks.strength.people --matches 40

plays battles of the model against one fighter of each level, by the original and by fair rules, and prints
how often it kills and dies, how much both carry at the end, and how often it carries more.
"""

import itertools
from typing import Annotated

import typer

from wildscav_engine.envs import SeatController
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import NAMED
from wildscav_stage.playing.plan import DEFAULT_MAP
from wildscav_training.opponents import named_agent
from wildscav_training.trials import mean, play_out, rate

ROBOTS = ("fighter-easy", "fighter", "fighter-hard")


def play(agent: SeatController, robot: str, rules: str, seed: int) -> tuple[int, int, int, int]:
    """Let an agent play a match; return its kills, its deaths, its supplies, and those of the robot."""
    spec = MatchSpec(
        track="battle",
        map=MapSpec(config=DEFAULT_MAP, seed=seed % 10),
        seed=seed,
        seats=(SUBMISSION, robot),
        rules=NAMED[rules],
    )
    batch, _ = play_out([(agent, [0])], spec, [0])
    agents = batch.state.agents
    own, other = agents.supplies[0].tolist()
    return int(agents.kills[0, 0]), int(agents.deaths[0, 0]), own, other


def main(
    agents: Annotated[
        str, typer.Option(help="Who plays, separated by commas.")
    ] = "benchmarks/strength/person",
    matches: Annotated[int, typer.Option(help="Matches against each robot.", min=2)] = 40,
) -> None:
    """Play and print a table in Markdown."""
    print("| agent | rules | against | kills | deaths | supplies | the robot's | carries more |")
    print("|---|---|---|---|---|---|---|---|")
    played = {name: named_agent(name) for name in agents.split(",")}
    for name, rules, robot in itertools.product(played, NAMED, ROBOTS):
        kills, deaths, own, other = zip(
            *(play(played[name], robot, rules, seed) for seed in range(matches)), strict=True
        )
        more = [float(mine > theirs) for mine, theirs in zip(own, other, strict=True)]
        means = [mean(kills, digits=1), mean(deaths, digits=1), mean(own, digits=0), mean(other, digits=0)]
        print(f"| `{name}` | {rules} | `{robot}` | {' | '.join(means)} | {rate(more)} |", flush=True)


if __name__ == "__main__":
    typer.run(main)
