"""What the process of a table is told when it starts, and what it tells."""

from typing import Literal

from wildscav_leaderboard.seasons.editions import Part

SEEDS = 2**53  # from which the seeds of maps are drawn; a season's own follow from its secrets


class Order(Part):
    """A table that is to be served. It goes through a pipe, as it holds a secret."""

    season: str  # folder
    settings: str  # of the season, JSON
    socket: str  # path of the Unix socket to listen on
    records: str  # folder for what matches leave behind
    base: str  # URL of the table's site, which ends with a slash
    secret: str  # of the person's seat
    archive: str  # of the submission
    entrant: str
    title: str  # the submission's name as people read it
    track: str
    seed: int  # of the map and of the first match


class Told(Part):
    """A line from the process: its table is ready and how guests come to it, or has ended and why."""

    state: Literal["ready", "ended", "failed"]
    code: str = ""  # by which guests come to a table that is ready; it changes
    why: str = ""  # one line: for the person, or if it failed, for the organizers alone
