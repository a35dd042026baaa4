"""The suite of hard country: what rules of thumb cannot solve, and fights that cannot be avoided.

The suite ``fair`` has the same gatherings and fights by rules that a person and a camera can keep up with.
"""

from collections.abc import Callable

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import NAMED, Rules
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave
from wildscav_evaluator.seats import battle_seats, shuffled
from wildscav_evaluator.suites.match_drawing import capture, choose, navigation
from wildscav_evaluator.suites.suite import Suite, TrackSettings

TIME_LIMIT = 120.0  # s, four times what the longest ways take at full speed
FIGHT_TIME = 180.0  # s
ROBOTS = 9
# Rounds for a whole match, and more to win and to lose by a death than by default.
RULES = Rules(spare_ammo=300, respawn_time=45.0, invincible_time=2.0, supply_loss=1.0)
# No single death decides: it costs a quarter of what is carried, and a twelfth of the time. Kills count in
# the score, so that it tells fighters apart: see ``benchmarks/strength/luck.py``.
FAIR_RULES = NAMED["fair"]._replace(
    spare_ammo=300, respawn_time=15.0, invincible_time=2.0, supply_loss=0.25, bounty=20
)
FEW_BOXES = SupplyWave(center=(0.0, 0.0), radius=60.0, outdoor_richness=4.0, indoor_richness=5.0)


def expert_map(_: RandomStream) -> MapConfig:
    """Return the config of maps at level expert: few ways lead through them, and targets are hidden."""
    return LEVELS["expert"]


def meeting_ground(dice: RandomStream) -> MapConfig:
    """Return the config of a map on which ten agents meet: 120 to 160 m, with a few houses and woods."""
    size = choose(dice, (120, 140, 160))
    return MapConfig(
        size=size,
        houses=dice.integer(3, 6),
        density="high" if dice.integer(0, 1) else "low",
        storeys=(1, 2),
        relief=choose(dice, (0.4, 0.8, 1.2)),
        ruggedness=choose(dice, (0.1, 0.4, 0.7)),
        water=choose(dice, (0.0, 0.05)),
        vegetation=choose(dice, (0.3, 0.5)),
    )


def moving_supplies(dice: RandomStream) -> SupplyConfig:
    """Return few boxes all over the map, and a hot spot that moves to the end of a match."""
    interval = choose(dice, (20.0, 25.0, 30.0))
    hot_spot = HotSpot(
        interval=interval,
        places=int(FIGHT_TIME // interval),
        radius=choose(dice, (5.0, 8.0)),
        boxes=choose(dice, (10, 15)),
        quantity=(10, 30),
    )
    return SupplyConfig(waves=(FEW_BOXES,), spacing=5.0, outdoor_quantity=(1, 3), hot_spot=hot_spot)


def gathering(rules: Rules) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws matches of one submission against gatherers around the hot spot."""

    def draw(dice: RandomStream) -> MatchSpec:
        seats = shuffled(dice, (SUBMISSION, *("gatherer",) * 5))
        supplies = moving_supplies(dice)
        return MatchSpec(
            track="gathering", time_limit=FIGHT_TIME, seats=seats, supplies=supplies, rules=rules
        )

    return draw


def fight(track: str, rules: Rules) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws matches of one submission against fighters and gatherers."""

    def draw(dice: RandomStream) -> MatchSpec:
        supplies = moving_supplies(dice)
        seats = battle_seats(dice, ROBOTS)
        return MatchSpec(track=track, time_limit=FIGHT_TIME, seats=seats, supplies=supplies, rules=rules)

    return draw


def meetings(gathering_rules: Rules, fighting_rules: Rules) -> dict[str, TrackSettings]:
    """Return the tracks on which agents meet at the hot spot, by given rules."""
    return {
        "gathering": TrackSettings(maps=10, episodes=2, draw=gathering(gathering_rules)),
        "battle": TrackSettings(maps=10, episodes=2, draw=fight("battle", fighting_rules)),
        "royale": TrackSettings(maps=10, episodes=2, draw=fight("royale", fighting_rules)),
    }


WILD = Suite(
    name="wild",
    title="matches that rules of thumb do not win: mazes to cross, and agents that meet at a rich hot spot",
    map_config=meeting_ground,
    tracks={
        "navigation": TrackSettings(maps=25, episodes=4, draw=navigation(TIME_LIMIT), map_config=expert_map),
        "capture": TrackSettings(maps=25, episodes=4, draw=capture(TIME_LIMIT, 3), map_config=expert_map),
        **meetings(Rules(), RULES),
    },
)
FAIR = Suite(
    name="fair",
    title="gatherings and fights as in wild, seen by eyes, with bodies that turn and aim as a person can",
    map_config=meeting_ground,
    tracks=meetings(NAMED["fair"], FAIR_RULES),
)
