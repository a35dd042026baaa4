"""What a team may do with webhooks."""

import pytest
from standardwebhooks import Webhook as Signer
from tests.leaderboard.seasons_made import NOON, team_with_member

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.refusals import InvalidError, NotFoundError, RefusalError
from wildscav_leaderboard.webhooks.service import (
    MAX_WEBHOOKS,
    add_webhook,
    own_webhook,
    queue_message,
    remove_webhook,
    webhooks_of,
)


@pytest.mark.parametrize(
    ("url", "reason"),
    [
        ("ftp://example.org/", "must begin with https:// or http://"),
        ("example.org", "must begin with"),
        ("", "must begin with"),
        ("https://", "must begin with"),
        ("https:///hook", "must begin with"),
        ("https://example.org/\x1b[2J", "must begin with"),
        ("https://example.org:port/", "must begin with"),
        ("https://example.org/" + "a" * 500, "at most 500 characters"),
        ("http://192.0.2.1:70000/x", "the port of a webhook is 70000, must be 1 to 65535"),
        ("http://192.0.2.1:0/x", "must be 1 to 65535"),
        ("http://xn--a/", "the name in the address of a webhook is not valid"),
        ("http://xn--/", "the name in the address of a webhook is not valid"),
        ("https://me:secret@example.org/", "must not contain a name or a password"),
    ],
)
def test_what_is_no_address_of_a_receiver_is_refused(database: Database, url: str, reason: str) -> None:
    with database.writing() as session:
        foxes, _ = team_with_member(session, "foxes")
        with pytest.raises(InvalidError, match=reason):
            add_webhook(session, foxes, url, NOON)


def test_a_team_has_a_few_webhooks_each_with_a_secret_of_its_own(database: Database) -> None:
    with database.writing() as session:
        foxes, _ = team_with_member(session, "foxes")
        owls, _ = team_with_member(session, "owls")
        added = [
            add_webhook(session, foxes, f"https://example.org/{number}", NOON)
            for number in range(MAX_WEBHOOKS)
        ]
        with pytest.raises(RefusalError, match="at most 5 webhooks"):
            add_webhook(session, foxes, "https://example.org/more", NOON)
        assert len({one.secret for one in added}) == MAX_WEBHOOKS
        assert Signer(added[0].secret).sign("msg_1", NOON, "{}").startswith("v1,")
        assert webhooks_of(session, foxes) == added
        assert webhooks_of(session, owls) == []


def test_the_webhook_of_another_team_does_not_exist(database: Database) -> None:
    with database.writing() as session:
        foxes, _ = team_with_member(session, "foxes")
        owls, _ = team_with_member(session, "owls")
        webhook = add_webhook(session, foxes, "https://example.org/", NOON)
        for attempt in (own_webhook, remove_webhook):
            with pytest.raises(NotFoundError, match=f"your team has no webhook {webhook.id}"):
                attempt(session, owls, webhook.id)
        assert queue_message(session, owls.id, "submission.active", {}, NOON) == []
        assert webhooks_of(session, foxes) == [webhook]
