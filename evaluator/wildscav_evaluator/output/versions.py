"""The versions that scores depend on: only what was played by the same ones can be compared."""

from wildscav_engine import ENGINE_VERSION, SIMULATION_VERSION
from wildscav_engine.maps import GENERATOR_VERSION
from wildscav_engine.record import RECORD_VERSION
from wildscav_evaluator.output.json_files import FileModel


class Versions(FileModel):
    """Which versions of Wildscav's parts played an evaluation."""

    engine: str  # of the whole package
    simulation: int  # of the rules
    generator: int  # of the maps
    record: int  # of the format of records

    def __str__(self) -> str:
        """Name them all in one line."""
        return (
            f"engine {self.engine}, simulation {self.simulation}, generator {self.generator}, "
            f"records {self.record}"
        )


CURRENT_VERSIONS = Versions(
    engine=ENGINE_VERSION,
    simulation=SIMULATION_VERSION,
    generator=GENERATOR_VERSION,
    record=RECORD_VERSION,
)
