"""Results of tournaments, written by hand."""

from collections.abc import Mapping, Sequence

from wildscav_evaluator.output.results import (
    CURRENT_VERSIONS,
    Evaluation,
    MatchRow,
    Results,
    SeatRow,
    Timings,
    TournamentSettings,
    metric_infos,
)
from wildscav_evaluator.scores.score import summary


def seat(number: int, entrant: str, team: int | None = None, **metrics: float) -> SeatRow:
    """One seat, by default a team of its own; metrics that are not given are 0."""
    return SeatRow(
        seat=number,
        submission=entrant,
        team=number if team is None else team,
        status="finished",
        metrics=metrics,
    )


def results_of(track: str, matches: Mapping[int, Sequence[SeatRow]], seats: int = 2) -> Results:
    """The results of matches, by their numbers. One without seats was broken by the platform."""
    metrics = metric_infos(track)
    nothing = dict.fromkeys((metric.name for metric in metrics), 0.0)
    entrants = sorted({str(one.submission) for rows in matches.values() for one in rows})
    rows: dict[str, list[MatchRow]] = {name: [] for name in entrants}
    for index, found in sorted(matches.items()):
        whole = [one.model_copy(update={"metrics": nothing | one.metrics}) for one in found]
        for name in entrants:
            own = tuple(one for one in whole if one.submission == name)
            if own:
                rows[name].append(MatchRow.of(index, own, f"records/{track}-{index:03d}.wsr"))
            elif not found:
                rows[name].append(MatchRow(index=index, status="failed", fault="platform"))
    return Results(
        versions=CURRENT_VERSIONS,
        suite="quick",
        seed=0,
        sandbox="process",
        tournament=TournamentSettings(seats=seats),
        evaluations=tuple(
            Evaluation(
                submission=name,
                version="1.0.0",
                digest="0" * 32,
                track=track,
                metrics=metrics,
                matches=tuple(rows[name]),
                summary=summary(metrics, rows[name]),
            )
            for name in entrants
        ),
        timings=Timings(started="2030-01-01T00:00:00+00:00", wall=0.0, jobs=1, matches=()),
    )
