"""The settings of a tournament that its matches depend on, besides the suite, the seed and the entrants."""

from typing import Annotated

from pydantic import Field

from wildscav_evaluator.output.json_files import FileModel

SCHEDULE_VERSION = 1  # rises whenever the same settings and seed give another schedule
Count = Annotated[int, Field(ge=1, le=1000)]


class TournamentSettings(FileModel):
    """Who sits where in the matches of a tournament."""

    seats: Count  # that entrants fill in a match
    team_size: Count = 1  # seats of a team
    mixed: bool = False  # whether the seats of a team are different entrants; else they are all one entrant
    repeats: Count = 2  # how often a game (a map and a match seed) is played, each time in other seats
    robots: tuple[str, ...] = ()  # that fill further seats of every match and are not rated
    meet_own: bool = False  # whether two entries of one submission may meet
    schedule: int = SCHEDULE_VERSION  # the version of the schedule

    @property
    def places(self) -> int:
        """The number of entrants in a match."""
        return self.seats if self.mixed else self.seats // self.team_size
