"""The users as which agents run."""

import os

import pytest

from wildscav_evaluator.sandbox.linux.users import AT_ONCE, OWN_USERS, agent_user


@pytest.mark.parametrize("process", [1, 2_097_152, 4_194_303])  # the last is the highest that Linux gives
def test_every_process_has_users_of_its_own_that_container_engines_take(
    monkeypatch: pytest.MonkeyPatch, process: int
) -> None:
    monkeypatch.setattr(os, "getpid", lambda: process)

    users = {agent_user() for _ in range(AT_ONCE)}

    assert users == {OWN_USERS + process * AT_ONCE + slot for slot in range(AT_ONCE)}
    assert max(users) < 2**31
