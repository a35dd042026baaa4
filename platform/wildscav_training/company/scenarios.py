"""The scenarios: matches in which an agent meets company that it cannot have trained with.

The idea is that of Melting Pot (Agapiou et al., "Melting Pot 2.0", 2022): a score for each scenario, where 0
is what ``random`` reaches and 1 what ``commando`` does. They are frozen: what changes gets another name.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import NamedTuple

from wildscav.baselines import PREFIX
from wildscav_engine.envs import SeatController
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import NAMED
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase
from wildscav_engine.tracks import TRACKS
from wildscav_training.opponents import submission
from wildscav_training.trials import Trial, half_width, play

AGENT = "agent"  # in a seat: the agent that is measured
HELD_OUT = ("greedy", "sniper", "hider")  # the folders beside this file
RANDOM, REFERENCE = "random", "commando"  # the agents whose scores are 0 and 1
SCORE = "score"  # the metric
TIME_LIMIT = 60.0  # s

GROUND = MapConfig(
    size=120, houses=4, density="low", storeys=(1, 2), relief=0.8, ruggedness=0.4, water=0.03, vegetation=0.4
)
FEW_BOXES = SupplyConfig(
    waves=(SupplyWave(center=(0.0, 0.0), radius=60.0, outdoor_richness=4.0, indoor_richness=5.0),),
    spacing=5.0,
    outdoor_quantity=(1, 3),
)
HOT_SPOT = HotSpot(interval=20.0, places=3, radius=8.0, boxes=10, quantity=(10, 30))
SUPPLIES = FEW_BOXES.model_copy(update={"hot_spot": HOT_SPOT})
RULES = NAMED["fair"]._replace(
    spare_ammo=150, respawn_time=10.0, invincible_time=2.0, supply_loss=0.25, bounty=20
)
# Who hides is left alone for half of the time; then the zone drives all together, and at last away.
LATE_ZONE = ZoneConfig(
    phases=(
        ZonePhase(wait=30.0, shrink=10.0, share=0.4, damage=2),
        ZonePhase(wait=2.0, shrink=8.0, share=0.0, damage=25),
    )
)


class Scenario(NamedTuple):
    """Who meets whom. An agent's score is the mean over its seats of the track's first metric."""

    track: str
    seats: tuple[str, ...]  # AGENT, one of HELD_OUT or a baseline
    teams: tuple[int, ...] | None = None  # None: each seat for itself
    supplies: SupplyConfig = SUPPLIES
    zone: ZoneConfig | None = None


SCENARIOS: Mapping[str, Scenario] = {
    # Three run after others and take their boxes.
    "rivals": Scenario("gathering", (AGENT, "greedy", "greedy", "greedy")),
    # A teammate takes the boxes near the agent and never fights, and two hunters are against both.
    "greedy-mate": Scenario("battle", (AGENT, "greedy", "hunter", "hunter"), teams=(0, 0, 1, 1)),
    # Two shoot from afar and run from whoever comes near, and one gathers.
    "snipers": Scenario("battle", (AGENT, "sniper", "sniper", "scavenger")),
    # Four take no part: they must be found, or outlived in the zone.
    "hiders": Scenario("royale", (AGENT, *("hider",) * 4), supplies=FEW_BOXES, zone=LATE_ZONE),
    "copies": Scenario("battle", (AGENT,) * 4),
    "crowd": Scenario("battle", (AGENT, "commando", "hunter", "scavenger", "homing")),
    # Alone among many of a kind, and many of a kind with visitors.
    "visitor": Scenario("battle", (AGENT, *("hunter",) * 4)),
    "residents": Scenario("battle", (AGENT, AGENT, AGENT, "sniper", "hunter")),
}


def matches_of(scenario: Scenario, count: int) -> Iterator[MatchSpec]:
    """Yield the first matches of a scenario, each on a test map of its own."""
    pool = random_maps(GROUND, split="test", size=count)
    for number in range(count):
        yield MatchSpec(
            track=scenario.track,
            map=pool[number].spec,
            seed=number,
            seats=(SUBMISSION,) * len(scenario.seats),
            teams=scenario.teams,
            time_limit=TIME_LIMIT,
            supplies=scenario.supplies,
            zone=scenario.zone,
            rules=RULES,
        )


def company_of(scenarios: Iterable[Scenario]) -> dict[str, SeatController]:
    """Return by name who fills seats of scenarios, and whom agents are measured by."""
    names = {name for scenario in scenarios for name in scenario.seats} | {RANDOM, REFERENCE}
    return {
        name: submission(Path(__file__).parent / name if name in HELD_OUT else PREFIX + name)
        for name in sorted(names - {AGENT})
    }


def play_in(
    scenario: Scenario, agent: SeatController, company: Mapping[str, SeatController], spec: MatchSpec
) -> Trial:
    """Let an agent play in its seats of a match of a scenario, and the company in the others."""
    own = [seat for seat, name in enumerate(scenario.seats) if name == AGENT]
    others = [(company[name], seat) for seat, name in enumerate(scenario.seats) if name != AGENT]
    trial = play(agent, spec, own, others)
    score = trial.metrics[TRACKS[scenario.track].metrics[0].name]
    return trial._replace(metrics={**trial.metrics, SCORE: score})


def normalized(own: Sequence[float], random: Sequence[float], reference: Sequence[float]) -> list[float]:
    """Return a value for each match whose mean is the normalized score: 0 for random, 1 for the reference.

    All three have played the same matches. The values spread as a ratio of means does (the delta method), so
    the interval of their mean is that of the score. If the reference cannot be told from random, none return.
    """
    leads = [mine - theirs for mine, theirs in zip(own, random, strict=True)]
    spans = [best - theirs for best, theirs in zip(reference, random, strict=True)]
    span = fmean(spans)
    if span <= half_width(spans):
        return []
    score = fmean(leads) / span
    return [score + (lead - score * own_span) / span for lead, own_span in zip(leads, spans, strict=True)]
