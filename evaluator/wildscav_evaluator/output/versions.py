"""The versions that scores depend on. Only results of equal versions can be compared."""

from wildscav_engine import ENGINE_VERSION, SIMULATION_VERSION
from wildscav_engine.maps import GENERATOR_VERSION
from wildscav_engine.record import RECORD_VERSION
from wildscav_evaluator.output.json_files import FileModel


class Versions(FileModel):
    """The versions of Wildscav's parts with which an evaluation was played."""

    engine: str  # of the whole package
    simulation: int  # of the rules
    generator: int  # of the maps
    record: int  # of the format of records

    def __str__(self) -> str:
        """Return all versions in one line."""
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
