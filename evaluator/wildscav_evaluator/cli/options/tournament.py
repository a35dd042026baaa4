"""What a tournament is to play: the entrants, and who sits where, from the arguments of its command."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from wildscav.errors import UserError
from wildscav.terminal.console import counted
from wildscav.terminal.suggestions import did_you_mean
from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_engine.specs.actions import Field
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.bounds import FEWEST_ENTRANTS, MAX_ENTRANTS
from wildscav_evaluator.cli.options.evaluation import TournamentOptions
from wildscav_evaluator.cli.options.selection import check_plays, load_named
from wildscav_evaluator.output.results import TournamentSettings
from wildscav_evaluator.seats import BATTLE_ROBOTS, ROBOT_ENTRANT
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.suite import Suite
from wildscav_evaluator.tournaments.drawing import has_teams
from wildscav_evaluator.tournaments.names import with_unique_names

MAX_SEATS = 1000  # of a match
MAX_DIGITS = 9  # of a number of robots that are read: more are too many anyway
USUAL_SEATS = 4  # where a suite's matches have a single seat
USUAL_TEAM = 2  # seats of a team on a track whose seats form teams


def load_entrants(
    named: Sequence[str], track: str, *, meet_own: bool
) -> tuple[tuple[Submission, ...], tuple[str, ...]]:
    """Return the submissions of a tournament, with unique names, and the names of its robots.

    ``named`` has folders, archives, ``image:NAME``, baselines and ``robot:NAME``. UserError if one is not
    valid or does not play the track, or if there are too few or too many.
    """
    robots = [name.removeprefix(ROBOT_ENTRANT) for name in named if name.startswith(ROBOT_ENTRANT)]
    for robot in robots:
        _check_robot(robot)
        if robots.count(robot) > 1:
            raise UserError(f"{ROBOT_ENTRANT}{robot} is entered twice", exit_code=2)
    if not FEWEST_ENTRANTS <= len(named) <= MAX_ENTRANTS:
        raise UserError(
            f"a tournament has {FEWEST_ENTRANTS} to {MAX_ENTRANTS:,} entrants; "
            f"{counted(len(named), 'entrant')} {'is' if len(named) == 1 else 'are'} named",
            exit_code=2,
        )
    submissions = [_load_submission(name) for name in named if not name.startswith(ROBOT_ENTRANT)]
    for submission in submissions:
        check_plays(submission, track)
    return with_unique_names(submissions, meet_own=meet_own), tuple(robots)


def _load_submission(name: str) -> Submission:
    """Read an entrant that is no robot; UserError if it is not valid, or a robot's name alone."""
    if name in ROBOTS and not Path(name).exists():
        raise UserError(
            f"there is no submission {name!r}; to enter the robot, write {ROBOT_ENTRANT}{name}", exit_code=2
        )
    return load_named(Path(name))


def most_entries(submissions: Sequence[Submission]) -> int:
    """Return how many of some submissions are entries of one submission, at most; 1 if there are none."""
    return max(Counter(one.manifest.name for one in submissions).values(), default=1)


def chosen_settings(
    asked: TournamentOptions, entrants: int, entries: int, suite: Suite, track: str
) -> TournamentSettings:
    """Return who sits where; what is not asked for depends on the track, the suite and the entrants.

    ``entries`` is how many of them are entries of one submission, at most. UserError if they cannot be seated
    like that.
    """
    size = asked.team_size or (USUAL_TEAM if has_teams(track) else 1)
    if asked.mixed and size == 1:
        raise UserError("--mixed needs teams of two or more seats: give a --team-size", exit_code=2)
    apart = 1 if asked.meet_own else entries
    if entrants < 2 * apart:
        raise UserError(
            f"{apart} of the {entrants} entrants are entries of one submission, which do not meet: name more "
            "entrants, or let them meet with --meet-own",
            exit_code=2,
        )
    seats = asked.seats
    if seats is None:
        usual = len(suite.matches(track, 0)[0].seats)
        wanted = usual if usual > 1 else USUAL_SEATS
        teams = max(2, min(wanted // size, entrants // apart // (size if asked.mixed else 1)))
        seats = teams * size
    places = _places(entrants, seats, size, mixed=asked.mixed)
    return TournamentSettings(
        seats=seats,
        team_size=size,
        mixed=asked.mixed,
        repeats=min(2, places) if asked.repeats is None else asked.repeats,
        robots=robots_asked(asked.robots or "", track, MAX_SEATS - seats),
        meet_own=asked.meet_own,
    )


def _places(entrants: int, seats: int, size: int, *, mixed: bool) -> int:
    """Return how many entrants a match has, whose seats are in teams of a size.

    UserError if there are fewer, or the seats are no whole teams.
    """
    if seats % size:
        raise UserError(f"--seats is {seats}, must be a multiple of the team size {size}", exit_code=2)
    if mixed and entrants < 2 * size:
        raise UserError(
            f"two mixed teams of {size} need {2 * size} entrants; {entrants} are named: give a smaller "
            "--team-size",
            exit_code=2,
        )
    places = seats if mixed else seats // size
    if entrants < places:
        raise UserError(
            f"a match with {seats} seats needs {places} entrants; {entrants} are named: give fewer --seats",
            exit_code=2,
        )
    return places


def robots_asked(text: str, track: str, most: int) -> tuple[str, ...]:
    """Return the robots that fill further seats, from their number, or their names, separated by commas.

    UserError if they are more than ``most``, or one does not exist.
    """
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    numbered = text.isdecimal()
    count = int(text.lstrip("0")[:MAX_DIGITS] or "0") if numbered else len(names)
    if count > most:
        raise UserError(
            f"--robots asks for too many robots; a match has at most {MAX_SEATS:,} seats, and so here at "
            f"most {most:,} robots",
            exit_code=2,
        )
    if numbered:
        kinds = BATTLE_ROBOTS if Field.SHOOT in TRACKS[track].fields else (TRACKS[track].robot,)
        return tuple(kinds[number % len(kinds)] for number in range(count))
    for name in names:
        _check_robot(name)
    return names


def _check_robot(name: str) -> None:
    if name not in ROBOTS:
        raise UserError(
            f"there is no robot {name!r}{did_you_mean(name, ROBOTS)}; the robots are {', '.join(ROBOTS)}",
            exit_code=2,
        )
