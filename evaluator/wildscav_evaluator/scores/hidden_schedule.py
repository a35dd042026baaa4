"""The check of a tournament whose seed is hidden, with what is known of its schedule without the seed.

Which entrants meet in which match is known only once the secret is opened. But every match has as many
entrants and the same kinds of seats, and everyone plays equally often. This is enough to notice a match that
was left out, and a seat that was given to another entrant.
"""

from collections import Counter
from collections.abc import Iterator, Sequence

from wildscav.terminal.console import counted
from wildscav_evaluator.output.results import Results
from wildscav_evaluator.output.tournament_settings import TournamentSettings
from wildscav_evaluator.scores.rescore import Replayed


def deviations(
    reported: Results, settings: TournamentSettings, replayed: Sequence[Replayed], count: int
) -> Iterator[str]:
    """Yield one line for each deviation from what any schedule of a tournament has.

    Args:
        reported: The results of the tournament.
        settings: Its settings.
        replayed: Its records, played again.
        count: How many matches it has.
    """
    entrants = Counter(row.index for one in reported.evaluations for row in one.matches)
    for index in range(count):
        if entrants[index] != settings.places:
            yield (
                f"match {index} of the tournament has results of {counted(entrants[index], 'entrant')}, "
                f"must be {settings.places}"
            )
    share = count * settings.places // len(reported.evaluations)
    for one in reported.evaluations:
        if len(one.matches) != share:
            yield (
                f"{one.submission} on {one.track}: {counted(len(one.matches), 'match')} in the results, but "
                f"every entrant of the tournament plays {share:,}"
            )
    for played in replayed:
        if played.spec is not None and not _is_seated(played, settings):
            yield f"{played.record}: its seats are not filled as the settings of the tournament say"


def _is_seated(played: Replayed, settings: TournamentSettings) -> bool:
    """Return whether entrants, their teams and other robots fill the seats of a record as they should."""
    if played.spec is None:
        return False
    entrants, teams = played.entrants, played.spec.team_of_seats
    others = [kind for seat, kind in enumerate(played.spec.seats) if seat not in entrants]
    members: dict[int, list[str]] = {}
    for seat, name in entrants.items():
        members.setdefault(teams[seat], []).append(name)
    different = settings.team_size if settings.mixed else 1  # entrants in a team
    return (
        len(entrants) == settings.seats
        and len({*entrants.values()}) == settings.places
        and sorted(others) == sorted(settings.robots)
        and all(len(team) == settings.team_size and len({*team}) == different for team in members.values())
    )
