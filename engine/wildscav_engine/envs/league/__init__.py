"""A league: past selves and robots as opponents, chosen by how well the learner does against each."""

from wildscav_engine.envs.league.league import League
from wildscav_engine.envs.league.table import LeagueError

__all__ = ["League", "LeagueError"]
