"""What `wildscav dataset` refuses before it plays anything."""

from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav_training.cli.dataset import _check_choice, _check_track


@pytest.mark.parametrize(
    ("records", "agent", "unused", "says"),
    [
        (None, None, {}, "there are no episodes: name record files, or an agent that plays with --agent"),
        ([Path("a.wsr")], "homing", {}, "records and --agent are both given"),
        ([Path("a.wsr")], None, {"--seed": 3}, "--seed goes only with --agent"),
        (None, "homing", {"--seat": [0], "--name": None}, "--seat goes only with records"),
    ],
)
def test_records_or_an_agent(
    records: list[Path] | None, agent: str | None, unused: dict[str, object], says: str
) -> None:
    with pytest.raises(UserError) as caught:
        _check_choice(records, agent, unused)
    assert says in str(caught.value)
    assert caught.value.exit_code == 2


def test_a_seed_of_zero_was_given_too() -> None:
    with pytest.raises(UserError, match="--seed goes only with --agent"):
        _check_choice([Path("a.wsr")], None, {"--seed": 0})


def test_a_misspelt_track_is_said() -> None:
    _check_track("battle")
    with pytest.raises(UserError, match=r"--track is 'batle' \(did you mean 'battle'\?\), must be one of"):
        _check_track("batle")
