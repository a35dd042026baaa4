"""What other packages add is found by name; what cannot be used is told of in one line, with its package."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav_engine import extensions
from wildscav_engine.compilation.caching import sources
from wildscav_engine.extensions import ExtensionError, Registry, names, other_groups, sources_of
from wildscav_engine.sensors import SENSORS
from wildscav_engine.sensors.base import Sensor
from wildscav_engine.simulation.robots.base import kind_number, levels_of
from wildscav_engine.simulation.robots.decide import ROBOTS, chain

Install = Callable[..., None]

SENSOR = """\
from typing import ClassVar
import numpy as np
from wildscav_engine.sensors.base import Column, Sensor, row_space, sensor

@sensor
class Nought(Sensor):
    name: ClassVar[str] = "nought"
    title: ClassVar[str] = "nothing"

    @property
    def space(self):
        return row_space((Column("nothing", "", 0, 1, "nothing"),))

    def read(self, match, seats):
        return np.zeros((len(seats), 1), np.float32)
"""


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Put a package with one module and one entry point where Python finds packages."""
    monkeypatch.syspath_prepend(tmp_path)
    for remembered in (extensions._entries, extensions._added):
        monkeypatch.setattr(extensions, remembered.__name__, remembered.__wrapped__)

    def make(package: str, code: str, group: str, name: str = "nought", thing: str = "Nought") -> None:
        module = package.replace("-", "_")
        (tmp_path / f"{module}.py").write_text(code)
        info = tmp_path / f"{module}-1.5.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.5\n")
        (info / "entry_points.txt").write_text(f"[{group}]\n{name} = {module}:{thing}\n")
        monkeypatch.delitem(sys.modules, module, raising=False)

    return make


def test_a_sensor_of_another_package_stands_after_ours(install: Install) -> None:
    install("fine-sensor", SENSOR, "wildscav.sensors")
    found: Registry[type[Sensor]] = Registry("wildscav.sensors")

    assert list(found) == [*SENSORS.built_in, "nought"]
    assert found["nought"]().name == "nought"
    assert str(found.origin("nought")) == "fine-sensor 1.5"
    assert [(one.name, one.problem) for one in found.additions()] == [("nought", "")]


WRONG = "the package wrong-one 1.5"
METRIC = "from wildscav_engine.simulation.track import Measure as M\nclass Nought(M): pass"


@pytest.mark.parametrize(
    ("kind", "code", "told"),
    [
        (
            "sensors",
            "import no_such_module",
            f"sensor 'nought' of {WRONG} cannot be used: ModuleNotFoundError",
        ),
        ("sensors", "", "AttributeError: module 'wrong_one' has no attribute"),
        ("tracks", "1/0", f"track 'nought' of {WRONG} cannot be used: ZeroDiv"),
        ("tracks", "class Nought: pass", "it is no class that derives from Track"),
        ("sensors", "class Nought: pass", "no class that derives from Sensor"),
        ("sensors", SENSOR.replace("@sensor", ""), "its class Nought is not decorated with @sensor"),
        ("sensors", SENSOR.replace('"nought"', '"zero"'), "its class is called 'zero'"),
        ("robots", "Nought = ()", "it is not what levels_of returns"),
        ("metrics", METRIC, "its class Nought has no metric, measure"),
    ],
)
def test_what_cannot_be_used_is_told_with_its_package(
    install: Install, kind: str, code: str, told: str
) -> None:
    install("wrong-one", code, f"wildscav.{kind}")
    found: Registry[object] = Registry(f"wildscav.{kind}")

    with pytest.raises(ExtensionError) as error:
        found["nought"]

    assert told in str(error.value)
    assert "wrong-one 1.5" in str(error.value)
    assert [one.problem for one in found.additions()] == [str(error.value)]


def test_a_name_of_ours_or_a_wrong_one_is_refused_and_our_ids_remain(install: Install) -> None:
    install("wrong-one", "", "wildscav.tracks", "battle", "Battle")
    with pytest.raises(ExtensionError, match=r"wrong-one 1\.5 adds a track 'battle', but Wildscav has one"):
        list(Registry("wildscav.tracks"))
    assert "battle" in names("wildscav.tracks")

    install("worse-one", "", "wildscav.robots", "Big Robot", "x")
    with pytest.raises(ExtensionError, match=r"worse-one 1\.5 adds a robot 'Big Robot', but a name must be"):
        list(Registry("wildscav.robots"))


def test_two_packages_with_one_name_are_both_named(install: Install) -> None:
    install("one-sensor", SENSOR, "wildscav.sensors")
    install("other-sensor", SENSOR, "wildscav.sensors")
    with pytest.raises(ExtensionError, match=r"(one|other)-sensor 1\.5 and (other|one)-sensor 1\.5 both add"):
        list(Registry("wildscav.sensors"))


def test_a_group_that_nobody_reads_is_told_of(install: Install) -> None:
    install("wrong-one", SENSOR, "wildscav.sensor")
    (found,) = other_groups({"wildscav.sensors"})
    assert found.problem == "there is no group wildscav.sensor; the groups are wildscav.sensors"


def test_the_kernels_of_robots_of_others_are_part_of_what_is_compiled(
    install: Install, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = sources.PACKAGE / "simulation" / "robots" / "decide.py"
    for remembered in (sources.sources_digest, sources.content_digest, sources.imported_files):
        monkeypatch.setattr(sources, remembered.__name__, remembered.__wrapped__)
    before, built_in = sources.sources_digest(file), sources_of("wildscav.robots")

    install("fine-robot", "LEVELS = 1", "wildscav.robots")
    assert sources_of("wildscav.robots") == (*built_in, tmp_path / "fine_robot.py")
    assert "fine_robot" not in sys.modules
    with_robot = sources.sources_digest(file)
    (tmp_path / "fine_robot.py").write_text("LEVELS = 2")

    assert len({before, with_robot, sources.sources_digest(file)}) == 3


def test_the_number_of_a_robot_follows_from_its_name_and_is_none_of_ours() -> None:
    levels = levels_of("orbiter", "walks in circles", ROBOTS["walker"].act)

    assert [level.name for level in levels] == ["orbiter-easy", "orbiter", "orbiter-hard"]
    assert [level.number for level in levels] == [721861810, 721861811, 721861812]
    assert 100 <= kind_number("orbiter") < 2**31 // 10


def test_two_robots_with_one_number_are_refused() -> None:
    one, other = (levels_of(name, "", ROBOTS["walker"].act, 7) for name in ("one", "other"))
    with pytest.raises(ExtensionError, match="robots 'one-easy' and 'other-easy' have the same number"):
        chain([one, other])
