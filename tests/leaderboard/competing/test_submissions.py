"""Handing in, following, listing and cancelling submissions."""

import os
import re
import shutil

import pytest
from tests.leaderboard.agents import write_agent
from tests.leaderboard.competing.season_site import Competitor, season_site

from wildscav_leaderboard.api.documents import SubmissionView
from wildscav_leaderboard.competing import texts
from wildscav_leaderboard.competing.season_client import SeasonClient
from wildscav_leaderboard.seasons.settings import Quotas
from wildscav_leaderboard.submissions.models import Submission

NASTY = "\x1b[2J\u202e[red]"


def test_a_folder_is_packed_as_it_is_played_and_handed_in(competitor: Competitor) -> None:
    competitor.logged_in("ada", "ants")
    agent = write_agent(competitor.folder, "walker")
    (agent / "__pycache__").mkdir()
    (agent / "__pycache__" / "agent.pyc").write_bytes(b"old")

    handed_in = competitor.document("submit", "walker", "-m", "faster")

    one = handed_in["submission"]
    assert (one["name"], one["state"], one["tracks"]) == ("walker", "submitted", ["navigation"])
    assert one["message"] == "faster"
    assert handed_in["quota"]["left_today"] == 2
    with competitor.site.database.reading() as session:
        stored = session.get_one(Submission, one["id"])
    shutil.unpack_archive(competitor.site.season.archives / stored.archive, competitor.folder / "unpacked")
    names = {path.name for path in (competitor.folder / "unpacked").rglob("*")}
    assert names == {"agent.py", "submission.toml"}


def test_an_archive_is_handed_in_as_it_is(competitor: Competitor) -> None:
    competitor.logged_in("bob", "bats")
    agent = write_agent(competitor.folder, "walker", tracks='["battle"]')
    archive = shutil.make_archive(str(competitor.folder / "walker"), "zip", agent)

    told = competitor.told("submit", archive)
    assert "walker 1.0, for battle" in told
    assert "2 of 3 submissions left today" in told


def test_what_would_be_refused_is_not_sent(competitor: Competitor) -> None:
    write_agent(competitor.folder, "walker")
    competitor.logged_in("carol")
    assert "you are in no team yet: `wildscav team create NAME`" in competitor.run("submit", "walker").stderr
    competitor.run("team", "create", "crows")
    for name in ("one", "two", "three"):
        competitor.submitted(name)
    assert "your team has used today's 3 submissions" in competitor.refused("submit", "walker")
    competitor.refused("submit", "nothing", code=2)


def test_the_seasons_refusals_are_told_in_one_line(competitor: Competitor) -> None:
    competitor.logged_in("dave", "ducks")
    competitor.submitted("walker")
    same = competitor.refused("submit", "walker")
    assert "has the same content on battle and is submitted: nothing was submitted or charged" in same
    write_agent(competitor.folder, "royal", tracks='["royale"]')
    none = competitor.refused("submit", "royal")
    assert "plays royale, and the season has only navigation, battle" in none
    with (write_agent(competitor.folder, "asker") / "submission.toml").open("a") as manifest:
        manifest.write("model = true\n")
    assert "asks a language model, and the season offers none" in competitor.refused("submit", "asker")
    checked = competitor.refused("check", "asker", "--season", competitor.site.url)
    assert "asks a language model, and the season offers none" in checked
    long = competitor.refused("submit", "royal", "-m", "x" * 2000)
    assert "message: String should have at most 1000 characters" in long


def test_waiting_shows_every_state_and_ends_when_the_submission_takes_part(competitor: Competitor) -> None:
    competitor.logged_in("erin", "emus")
    number = competitor.submitted("first") + 1
    conductor = competitor.site.conducted(number, "queued", "building", "validating", "active")
    write_agent(competitor.folder, "walker")

    told = competitor.told("submit", "walker", "--wait")
    conductor.join()
    states = [line.split()[2] for line in told.splitlines() if line.startswith("20")]
    assert states == ["submitted", "queued", "building", "validating", "active"]


def test_an_interruption_while_it_is_sent_says_how_to_look(
    competitor: Competitor, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    competitor.logged_in("uma", "urchins")
    write_agent(competitor.folder, "walker")
    monkeypatch.setattr(SeasonClient, "submit", interrupt)
    done = competitor.run("submit", "walker", "--wait")
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "wildscav: interrupted: `wildscav team submissions` tells whether it arrived\n"


def test_its_team_sees_how_far_a_validation_is(competitor: Competitor) -> None:
    competitor.logged_in("zoe", "zebras")
    number = competitor.submitted("walker")
    competitor.site.move(number, "queued", "building", "validating")
    assert "validating" in competitor.told("team", "submissions", number)  # though no line was written yet
    file = competitor.site.season.validation_file(number)
    file.parent.mkdir(parents=True)
    file.write_text("match: battle: 120 of 600 steps played")

    assert "match: battle: 120 of 600 steps played" in competitor.told("team", "submissions", number)
    shown = SubmissionView.model_validate(competitor.document("submissions", number)["submissions"][0])
    longer = shown.model_copy(update={"expected_wait": 0.0})  # it takes longer than others took
    assert texts.waiting(longer) == "match: battle: 120 of 600 steps played"
    competitor.logged_in("yan", "yaks")
    assert "steps played" not in competitor.told("team", "submissions", number)


def test_a_submission_that_fails_tells_whose_fault_it_was_and_what_shows_it_again(
    competitor: Competitor,
) -> None:
    competitor.logged_in("frank", "foxes")
    number = competitor.submitted("first") + 1
    failure = {
        "fault": "agent",
        "reason": f"match: it crashed {NASTY}",
        "last_lines": ["Traceback", f"ValueError: {NASTY}"],
        "command": "wildscav check DIR --sandbox process",
    }
    conductor = competitor.site.conducted(number, "queued", "failed", **failure)
    write_agent(competitor.folder, "walker")

    done = competitor.run("submit", "walker", "--wait")
    conductor.join()

    assert done.returncode == 1
    assert done.stderr == f"wildscav: submission {number} failed; the fault is the agent's\n"
    waited = competitor.run("team", "submissions", number, "--wait")
    assert (waited.returncode, waited.stderr) == (1, done.stderr)
    shown = competitor.told("team", "submissions", number)
    for text in (done.stdout, waited.stdout, shown):
        assert r"match: it crashed \x1b[2J\u202e[red]" in text
        assert r"ValueError: \x1b[2J\u202e[red]" in text
        assert "wildscav check DIR --sandbox process" in text
        assert "\x1b" not in text
        assert "\u202e" not in text


def test_lists_are_of_the_own_team_unless_others_are_asked_for(competitor: Competitor) -> None:
    competitor.logged_in("grace", "geese")
    numbers = [competitor.submitted(name, "-m", f"of {name}") for name in ("one", "two")]
    competitor.site.move(numbers[0], "queued", "failed", fault="platform", reason="no disk")
    key = competitor.run("team", "key").stdout.split()[-1]
    competitor.logged_in("heidi", "hens")
    other = competitor.submitted("three")

    def ids(*options: str) -> list[int]:
        return [one["id"] for one in competitor.document("submissions", *options)["submissions"]]

    assert ids() == [other]
    assert ids("--team", "geese") == numbers[1:], "failures are for the own team"
    assert ids("--team", "geese", "--state", "failed") == []
    assert ids("--all", "--limit", "2") == [other, numbers[1]]
    assert "of two" not in competitor.told("team", "submissions", "--all"), "messages are for the own team"
    competitor.logged_in("gus")
    competitor.run("team", "join", key)
    assert ids("--state", "failed") == numbers[:1]
    assert "failed (platform)" in competitor.told("team", "submissions")


def test_a_submission_that_waits_can_be_cancelled(competitor: Competitor) -> None:
    competitor.logged_in("ivan", "ibises")
    number = competitor.submitted("walker")
    assert competitor.document("cancel", number)["submission"]["state"] == "cancelled"
    again = competitor.refused("team", "submissions", "cancel", number)
    assert f"submission {number} is cancelled, and cannot become cancelled" in again
    unknown = competitor.refused("team", "submissions", "cancel", 10_000)
    assert unknown == "wildscav: there is no submission 10000\n"


def test_a_team_decides_what_takes_part_and_is_told_what_a_submission_replaces(
    competitor: Competitor,
) -> None:
    competitor.logged_in("tina", "terns")
    on_the_way = ("queued", "building", "validating", "active")
    numbers = [competitor.submitted(name) for name in ("one", "two")]
    for number in numbers:
        competitor.site.move(number, *on_the_way)
    first, second = numbers
    assert competitor.told("team", "submissions", "keep", first) == (
        f"submission {first} is active on battle, kept\n"
    )
    write_agent(competitor.folder, "three", tracks='["battle"]')
    shown = competitor.run("submit", "three", "--replaces", first).stdout
    assert re.search(rf"replaces +{first} on battle", shown)
    assert competitor.document("submissions", second + 1)["submissions"][0]["replaces"] == {"battle": first}
    refused = competitor.refused("team", "submissions", "cancel", second)
    assert f"takes part: `wildscav team submissions disable {second}` ends that" in refused
    done = competitor.document("submissions", "disable", second)["submission"]
    assert (done["state"], done["playing"]) == ("disabled", [])
    assert competitor.document("submissions", "restore", second)["submission"]["playing"] == ["battle"]
    assert competitor.run("team", "submissions", "keep").returncode == 2
    unknown = competitor.run("team", "submissions", "polish", first)
    assert "only cancel, disable, restore, keep, release" in unknown.stderr


def test_what_is_too_large_is_not_sent(
    competitor: Competitor, tmp_path_factory: pytest.TempPathFactory
) -> None:
    with season_site(tmp_path_factory.mktemp("small"), quotas=Quotas(archive=1)) as site:
        competitor.run("login", site.url, "--token", site.token("judy", "jays"))
        agent = write_agent(competitor.folder, "walker")
        (agent / "model.bin").write_bytes(os.urandom(2 << 20))

        folder = competitor.refused("submit", "walker")
        archive = competitor.refused("submit", shutil.make_archive(str(agent), "zip", agent))

    most = "more than 1 MiB, which is the most that the season takes"
    assert archive.endswith(f"walker.zip has {most}\n")
    assert folder.endswith(f"walker packs to {most}; its largest file is model.bin (2 MiB)\n")


def test_tracks_that_the_season_lacks_are_named(competitor: Competitor) -> None:
    competitor.logged_in("lara", "larks")
    write_agent(competitor.folder, "walker", tracks='["battle", "royale", "gathering"]')
    said = competitor.run("submit", "walker").stdout
    assert re.search(r"not played +royale, gathering: not in this season", said)
    write_agent(competitor.folder, "other", "    act = None\n", tracks='["battle", "royale"]')
    assert competitor.document("submit", "other")["not_played"] == ["royale"]


def test_a_ladder_that_waits_for_teams_says_so(competitor: Competitor) -> None:
    competitor.logged_in("swen", "swans")
    number = competitor.submitted("waiter")
    assert "its ladder" not in competitor.told("team", "submissions", number)
    competitor.site.move(number, "queued", "building", "validating", "active")
    shown = competitor.told("team", "submissions", number)
    assert re.search(r"battle +0 of 100 matches played", shown)
    assert re.search(r"team +Swans \(swans\)", shown)
