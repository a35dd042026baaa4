import subprocess
import sys
from io import BytesIO
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from PIL import Image
from rerun.chunk import RrdReader
from tests.builders import make_match
from tests.engine.view.agent_note import AgentNote

from wildscav_engine.record import Record
from wildscav_engine.sensors.display.colors import distance_colors
from wildscav_engine.view import ViewError, rendered, write_replay
from wildscav_engine.view.entities.agents import line_color
from wildscav_engine.view.entities.follow_cameras import distances_of
from wildscav_engine.view.outcome import describe_outcome
from wildscav_engine.view.recording.history import DEPTH_CAMERA, History, collect_history

RERUN = (sys.executable, "-m", "rerun")
BATTLE_ENTITIES = [
    *("/world/terrain", "/world/water", "/world/houses/walls", "/world/houses/roofs"),
    *("/world/vegetation/crowns", "/supplies", "/shots", "/events"),
    *("/follow/above", "/follow/eyes", "/follow/depth", "/follow/color"),
    *("/standings", "/kills", "/heat/few", "/heat/some", "/heat/many"),
    *(f"/agents/seat_{seat}/{part}" for seat in range(3) for part in ("body", "name", "health", "supplies")),
]


def rows_of(path: Path, entity: str, ending: str) -> tuple[list[int], list[object]]:
    """All values of one component of an entity over time, with their steps."""
    steps: list[int] = []
    values: list[object] = []
    for chunk in RrdReader(path).stream().filter(content=entity):
        batch: pa.RecordBatch = chunk.to_record_batch()
        names = [name for name in batch.schema.names if name.endswith(ending)]
        if names and "step" in batch.schema.names:
            steps += batch.column("step").cast(pa.int64()).to_pylist()
            values += batch.column(names[0]).to_pylist()
    order = np.argsort(steps, kind="stable")
    return [steps[index] for index in order], [values[index] for index in order]


def entities_of(path: Path) -> set[str]:
    return set(RrdReader(path).store().schema().entity_paths())


def test_everything_of_a_battle_is_in_the_file(battle_file: Path) -> None:
    checked = subprocess.run([*RERUN, "rrd", "verify", str(battle_file)], capture_output=True, text=True)

    assert checked.returncode == 0, checked.stderr
    assert entities_of(battle_file).issuperset(BATTLE_ENTITIES)
    assert len(RrdReader(battle_file).blueprints()) == 1


def test_agents_stand_where_they_stood(seen: History, battle_file: Path) -> None:
    for seat in range(3):
        steps, places = rows_of(battle_file, f"/agents/seat_{seat}", "translation")

        shown = np.array([place[0] for place in places])  # type: ignore[index]
        np.testing.assert_allclose(
            shown, seen.agents.position[steps][:, seat][:, [0, 2, 1]], atol=1e-5, err_msg=str(seat)
        )


def test_the_log_has_every_pick_up(seen: History, battle_file: Path) -> None:
    _, texts = rows_of(battle_file, "/events", "text")

    picked = [text for text in texts if "picks up" in str(text)]

    assert len(picked) == int(np.count_nonzero(seen.agents.gained)) > 0


def test_notes_are_in_the_log_drawn_and_plotted_from_their_step_on(battle: Record, tmp_path: Path) -> None:
    line = ((0.0, 1.0, 2.0), (3.0, 4.0, 5.0))
    notes = [
        AgentNote(1, 4, text="I hide."),
        AgentNote(1, 6, name="way/home", points=line),
        AgentNote(1, 9, name="way/home"),
        AgentNote(2, 7, name="fear", value=0.25),
    ]
    path = tmp_path / "notes.rrd"
    path.write_bytes(rendered(battle, images=False, notes=notes))
    steps, texts = rows_of(path, "/events", "text")
    (place,) = [at for at, text in enumerate(texts) if text == [f"{battle.names[1]}: I hide."]]
    (mark,) = {entity for entity in entities_of(path) if entity.endswith("/line")}

    assert steps[place] == 4
    assert steps == sorted(steps)
    assert mark.startswith("/marks/seat_1/way")
    drawn = rows_of(path, mark, "strips")
    assert drawn == ([6, 9], [[[[0.0, 2.0, 1.0], [3.0, 5.0, 4.0]]], []])
    assert rows_of(path, "/plots/seat_2/fear", "scalars") == ([7], [[0.25]])


def test_boxes_vanish_when_they_are_taken(battle_file: Path) -> None:
    steps, centers = rows_of(battle_file, "/supplies", "centers")
    counts = [len(boxes) for boxes in centers]  # type: ignore[arg-type]

    assert steps[0] == 0
    assert counts[-1] < counts[0]


def test_depth_maps_are_the_sensors_in_the_colours_of_look(seen: History, battle_file: Path) -> None:
    assert seen.depth is not None
    steps, buffers = rows_of(battle_file, "/follow/depth", "buffer")

    shades = np.array([np.frombuffer(bytes(buffer[0]), np.uint8) for buffer in buffers])  # type: ignore[index]
    shades = shades.reshape(-1, DEPTH_CAMERA.height, DEPTH_CAMERA.width)
    look = distance_colors(seen.depth.images.reshape(-1, DEPTH_CAMERA.width), DEPTH_CAMERA.far)
    shown = distance_colors(distances_of(shades).reshape(-1, DEPTH_CAMERA.width), DEPTH_CAMERA.far)

    assert steps == seen.depth.rows.tolist()
    assert np.abs(shown.astype(int) - look).max() <= 3  # of 255: half a shade
    # The square root of the distance is cut into 255 parts.
    np.testing.assert_allclose(
        np.sqrt(distances_of(shades) / 200), np.sqrt(seen.depth.images / 200), atol=0.002
    )


def test_pictures_are_the_cameras_but_for_what_jpeg_loses(seen: History, battle_file: Path) -> None:
    assert seen.color is not None
    steps, blobs = rows_of(battle_file, "/follow/color", "blob")

    shown = np.array([np.asarray(Image.open(BytesIO(bytes(blob[0])))) for blob in blobs])  # type: ignore[index]
    lost = np.abs(shown.astype(int) - seen.color.images).mean(axis=(1, 2, 3))

    assert steps == seen.color.rows.tolist()
    assert shown.shape == seen.color.images.shape
    assert lost.max() < 6


def test_the_standings_end_with_the_winner(battle: Record, battle_file: Path) -> None:
    steps, texts = rows_of(battle_file, "/standings", "text")
    _, events = rows_of(battle_file, "/events", "text")
    outcome = describe_outcome(battle.result, battle.names)

    assert steps[0] == 0
    assert steps[-1] == battle.steps
    assert str(events[-1]) == str([outcome])
    assert "# Supply battle" in str(texts[0])
    assert outcome.split(" with ")[0] in str(texts[-1]).replace("\\", "")
    assert outcome.split(" with ")[0] not in str(texts[0]).replace("\\", "")


def test_two_replays_in_one_viewer_keep_their_own_layouts(bare_files: dict[str, Path]) -> None:
    stores = [RrdReader(bare_files[track]).recordings()[0] for track in ("battle", "navigation")]

    assert stores[0].application_id != stores[1].application_id


def test_labels_tell_health_only_where_somebody_can_be_hurt(bare_files: dict[str, Path]) -> None:
    assert rows_of(bare_files["battle"], "/agents/seat_1/name", "labels")[1][0] == ["fighter 1 · 100"]
    assert rows_of(bare_files["navigation"], "/agents/seat_0/name", "labels")[1] == [["walker 0"]]


def test_a_royale_shows_its_zone_and_other_tracks_have_none(bare_files: dict[str, Path]) -> None:
    for track, path in bare_files.items():
        assert ({"/zone/edge", "/zone/next", "/zone/outside"} <= entities_of(path)) == (track == "royale")


@pytest.mark.parametrize(
    ("teams", "colors"),
    [
        ((0, 1, 2), 3),
        ((0, 0, 1), 2),  # teammates share the colour of their team
        ((0, 0, 0), 3),  # but for a single team: its lines would all look the same
    ],
)
def test_lines_in_plots_are_told_apart(teams: tuple[int, ...], colors: int) -> None:
    match = make_match("gathering", seats=3, teams=teams)
    history = collect_history([match], 0, None)[1]

    assert len({line_color(history, seat) for seat in range(3)}) == colors


def test_the_same_record_gives_the_same_recording(battle: Record, battle_file: Path, tmp_path: Path) -> None:
    write_replay(battle, tmp_path / "again.rrd", follow=1)

    compared = subprocess.run(
        [*RERUN, "rrd", "compare", "--unordered", str(battle_file), str(tmp_path / "again.rrd")],
        capture_output=True,
        text=True,
    )

    assert compared.returncode == 0, compared.stderr


@pytest.mark.parametrize("entity", ["/follow/depth", "/follow/color"])
def test_a_replay_without_images_has_none(bare_files: dict[str, Path], entity: str) -> None:
    chunks = RrdReader(bare_files["battle"]).stream().filter(content=entity)
    assert [chunk for chunk in chunks if "step" in chunk.timeline_names] == []


def test_the_first_seat_of_a_submission_is_followed(seen: History, bare_files: dict[str, Path]) -> None:
    steps, eyes = rows_of(bare_files["battle"], "/follow/eyes", "translation")

    expected = seen.agents.position[steps][:, 0][:, [0, 2, 1]] + np.array([0.0, 0.0, 1.5])
    np.testing.assert_allclose(np.array([eye[0] for eye in eyes]), expected, atol=1e-5)  # type: ignore[index]


def test_a_seat_that_is_not_there_cannot_be_followed(battle: Record, tmp_path: Path) -> None:
    with pytest.raises(ViewError, match="no seat 3 to follow: the record has seats 0 to 2"):
        write_replay(battle, tmp_path / "none.rrd", follow=3)

    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_one_clear_error(battle: Record, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"nowhere/match\.rrd"):
        write_replay(battle, tmp_path / "nowhere" / "match.rrd", images=False)


def test_a_failed_write_leaves_nothing(battle: Record, tmp_path: Path) -> None:
    (tmp_path / "taken.rrd").mkdir()

    with pytest.raises(OSError, match=r"taken\.rrd"):
        write_replay(battle, tmp_path / "taken.rrd", images=False)

    assert [path.name for path in tmp_path.iterdir()] == ["taken.rrd"]


def test_without_rerun_the_error_says_what_to_install(
    battle: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    for name in [name for name in sys.modules if name.startswith("wildscav_engine.view.")]:
        monkeypatch.delitem(sys.modules, name)

    with pytest.raises(ViewError, match=r"pip install 'wildscav\[view\]'"):
        write_replay(battle, tmp_path / "match.rrd")


def test_importing_the_package_does_not_import_rerun() -> None:
    """Videos need no Rerun either."""
    program = "import sys, wildscav_engine.view.video.encode; sys.exit('rerun' in sys.modules)"

    assert subprocess.run([sys.executable, "-c", program]).returncode == 0
