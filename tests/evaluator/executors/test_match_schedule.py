"""How long the processes of a cluster may be silent, without a cluster."""

from pathlib import Path
from types import SimpleNamespace
from unittest.mock import MagicMock

import pytest
from tests.evaluator.sample_agents import WALKER, Submit
from tests.evaluator.small_matches import job_of

from wildscav_evaluator.executors.cluster.match_host import Report


def test_a_match_may_take_longer_to_begin_than_to_go_on(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A node whose worker was killed starts another one for it, which takes long on a busy machine."""
    pytest.importorskip("ray")
    from wildscav_evaluator.executors.cluster import match_schedule
    from wildscav_evaluator.executors.cluster.match_schedule import Host, MatchSchedule

    walker = submit("walker", WALKER)
    node = MagicMock(cores=1, used=[SimpleNamespace(cores=1)])
    schedule = MatchSchedule(node, [job_of(walker, tmp_path)], 1, {walker.folder: MagicMock()})
    host = Host(node, 1, MagicMock(), None, is_ready=True)
    schedule._hosts.append(host)
    assigning = schedule._assign()
    next(assigning)
    with pytest.raises(StopIteration):
        assigning.send({})
    answered: list[object] = []
    ray = SimpleNamespace(wait=lambda *_, **__: (answered, []), get=lambda _: Report())
    monkeypatch.setattr(match_schedule, "ray", ray)

    host.silent = 600.0
    assert not list(schedule._answers())
    answered.append(host.answer)
    assert list(schedule._answers()) == [(host, Report())]
    answered.clear()
    host.answer, host.silent = object(), 121.0
    ((_, lost),) = schedule._answers()
    assert "did not answer within 120 s" in str(lost)
