"""Which match a person plays against a submission: one on a small map that nobody else has played on."""

from wildscav.play.plan import DEFAULT_MAP, FRAMES_PER_ACTION, Opponent, Plan
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.submissions.submission import Submission
from wildscav_leaderboard.playing.order import Order

ROBOTS = {"royale": ("fighter-easy",) * 4}  # besides the two, where two alone would be no match


def plan_of(order: Order, submission: Submission, longest: float) -> Plan:
    """Return the plan of a person's matches against a submission.

    Args:
        order: The order.
        submission: The submission.
        longest: s of game time that a match may take.
    """
    robots = ROBOTS.get(order.track, ())
    opponent = Opponent(order.title, submission.folder, submission.manifest.sensors)
    spec = MatchSpec(
        track=order.track,
        map=MapSpec(config=DEFAULT_MAP, seed=order.seed),
        seed=order.seed,
        seats=(SUBMISSION, SUBMISSION, *robots),
        time_limit=min(longest, TRACKS[order.track].time_limit),
        frames_per_action=FRAMES_PER_ACTION,
    )
    return Plan(spec, (opponent, *map(Opponent, robots)))
