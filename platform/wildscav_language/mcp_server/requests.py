"""The arguments of what clients may ask for, and the match that they describe."""

from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from wildscav.baselines import NAMES as BASELINES
from wildscav.baselines import baseline_folder
from wildscav.errors import UserError
from wildscav_engine.maps.catalogue import LAST_ID, map_spec
from wildscav_engine.maps.levels import LEVELS, Level
from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import RULES, Rules, Senses
from wildscav_engine.specs.validation import one_line
from wildscav_engine.tracks import TRACKS
from wildscav_language.body import UNARMED
from wildscav_server.hosting.opponents import Opponent, submission_opponent

MAX_CLIENTS = 8  # in one match
MAX_OTHERS = 30  # robots and baselines in one match
MAX_BASELINES = 8  # of them, because each is a process
LONGEST = 3600.0  # s of game time

Handle = Annotated[
    str,
    Field(max_length=40, alias="seat", description="the handle of your seat, from start_match or join_match"),
]
Code = Annotated[str, Field(max_length=40, description="the join code of the match")]
Marks = Annotated[
    bool, Field(description="whether the boxes and agents that you are told of have their numbers in it")
]
Name = Annotated[
    str, Field(pattern=r"^[\w][\w .'-]{0,19}$", description="what the seat is called in results and texts")
]


class Request(BaseModel):
    """Base of all requests."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class StartMatch(Request):
    """Start a match and take its first seat. The answer has the handle that every other call needs."""

    track: Annotated[str, Field(json_schema_extra={"enum": list(TRACKS)})] = "navigation"
    level: Annotated[Level, Field(description="difficulty of a random map")] = "easy"
    map: Annotated[
        int | None, Field(ge=1, le=LAST_ID, description="number of a known map, instead of a random one")
    ] = None
    seed: Annotated[int, Field(ge=0, lt=2**63, description="of the random map, the starts and the goals")] = 0
    others: Annotated[
        tuple[str, ...] | None,
        Field(
            max_length=MAX_OTHERS,
            description=f"who else plays: robots ({', '.join(ROBOTS)}), and baselines "
            f"({', '.join(BASELINES)}); by default, the robots that are usual on the track",
        ),
    ] = None
    clients: Annotated[
        int, Field(ge=1, le=MAX_CLIENTS, description="seats for clients: you, and others with the join code")
    ] = 1
    time_limit: Annotated[
        float | None, Field(gt=0, le=LONGEST, description="seconds of game time; by default the track's")
    ] = None
    rules: Annotated[Literal["original", "fair"], Field(description="named rules")] = "original"
    senses: Annotated[
        Literal["original", "sighted", "pixels"] | None,
        Field(description="what seats are told of agents and boxes; by default, as the rules say"),
    ] = None
    name: Name = "client"


def opponents_of(request: StartMatch) -> tuple[Opponent, ...]:
    """Return who plays in the seats behind those of clients.

    Raises:
        UserError: Somebody is asked for who does not exist or does not play the track.
    """
    track = TRACKS.get(request.track)
    if track is None:
        raise UserError(f"track is {request.track!r}; the tracks are {', '.join(TRACKS)}")
    usual = (track.robot,) * max(0, track.opponents + 1 - request.clients)
    names = usual if request.others is None else request.others
    chosen = tuple(_opponent(name, request.track) for name in names)
    if sum(other.folder is not None for other in chosen) > MAX_BASELINES:
        raise UserError(f"others has more than {MAX_BASELINES} baselines")
    return chosen


def _opponent(name: str, track: str) -> Opponent:
    if name in ROBOTS:
        return Opponent(name)
    if name in BASELINES:
        return submission_opponent(baseline_folder(name), track)
    robots, baselines = ", ".join(ROBOTS), ", ".join(BASELINES)
    raise UserError(f"others has {name[:40]!r}; the robots are {robots}, and the baselines {baselines}")


def spec_of(request: StartMatch, opponents: Sequence[Opponent]) -> MatchSpec:
    """Return the spec of a match, which waits for its seats.

    Raises:
        UserError: There is no such match.
    """
    filled = (SUBMISSION if other.folder else other.name for other in opponents)
    rules = _rules_of(request)
    if rules.senses == Senses.PIXELS and request.track not in UNARMED:
        tracks = " or ".join(track for track in UNARMED if track in TRACKS)
        raise UserError(f"senses is 'pixels', with which no seat of words can aim: play {tracks}")
    random_map = MapSpec(config=LEVELS[request.level], seed=request.seed)
    try:
        return MatchSpec(
            track=request.track,
            map=random_map if request.map is None else map_spec(request.map),
            seed=request.seed,
            seats=(*(SUBMISSION,) * request.clients, *filled),
            time_limit=request.time_limit or TRACKS[request.track].time_limit,
            rules=rules,
            clock="paused",
        )
    except ValidationError as error:
        raise UserError(f"such a match is not possible: {one_line(error)}") from None


def _rules_of(request: StartMatch) -> Rules:
    rules = RULES.validate_python(request.rules)
    return rules if request.senses is None else rules._replace(senses=int(Senses[request.senses.upper()]))
