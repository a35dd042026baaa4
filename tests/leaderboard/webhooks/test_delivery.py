"""Messages arrive signed, are sent again until they arrive or are given up, and go only where they may."""

import asyncio
import json
import socket
import threading
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select
from standardwebhooks import Webhook as Verifier
from standardwebhooks import WebhookVerificationError
from tests.leaderboard.seasons_made import team_with_member
from tests.leaderboard.webhooks.receivers import Receiver, receiver
from tests.platform.helpers.certificates import Authority

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.settings import Webhooks
from wildscav_leaderboard.teams.service import find_team
from wildscav_leaderboard.webhooks import delivery
from wildscav_leaderboard.webhooks.delivery import MAX_ATTEMPTS, Deliverer, Sender, next_attempt
from wildscav_leaderboard.webhooks.models import Delivery, Webhook
from wildscav_leaderboard.webhooks.service import add_webhook, queue_for, queue_message, remove_webhook

HERE = Webhooks(private_addresses=True)
DATA = {"submission": 7, "state": "active"}


def now() -> datetime:
    return datetime.now(UTC)


@pytest.fixture
def foxes(database: Database) -> int:
    with database.writing() as session:
        return team_with_member(session, "foxes")[0].id


@pytest.fixture
def there() -> Iterator[Receiver]:
    with receiver() as running:
        yield running


def hook(database: Database, url: str) -> Webhook:
    with database.writing() as session:
        return add_webhook(session, find_team(session, "foxes"), url, now())


def queue(
    database: Database, foxes: int, *, kind: str = "submission.active", at: datetime | None = None
) -> str:
    with database.writing() as session:
        (queued,) = queue_message(session, foxes, kind, DATA, at or now())
        return queued.event


def deliver_due(database: Database, settings: Webhooks, time: datetime) -> int:
    """Send the messages that are due, one for each webhook, and wait for their answers."""

    async def deliver() -> int:
        async with Sender(database, settings) as sender:
            return await sender.send_due(time)

    return asyncio.run(deliver())


def stored(database: Database, event: str) -> Delivery:
    with database.reading() as session:
        return session.scalars(select(Delivery).filter_by(event=event)).one()


def disabled(database: Database, webhook: Webhook) -> str | None:
    with database.reading() as session:
        return session.get_one(Webhook, webhook.id).disabled


def test_a_message_is_verified_by_the_library_of_its_receiver(database: Database, foxes: int) -> None:
    with receiver() as there:
        webhook = hook(database, there.url())
        event = queue(database, foxes)

        assert deliver_due(database, HERE, now()) == 1
        assert deliver_due(database, HERE, now() + timedelta(days=9)) == 0  # it is not sent again

    ((headers, body),) = there.got
    sent = Verifier(webhook.secret).verify(body, headers)
    assert (sent["type"], sent["data"]) == ("submission.active", DATA)
    named = [headers[name] for name in ("webhook-id", "host", "content-type")]
    assert named == [event, f"127.0.0.1:{there.port}", "application/json"]
    with pytest.raises(WebhookVerificationError):
        Verifier(webhook.secret).verify(body.replace("active", "failed"), headers)
    assert stored(database, event).delivered is not None


def test_a_message_is_sent_again_with_the_same_identifier_after_a_restart(
    database: Database, foxes: int
) -> None:
    with receiver(500, 503) as there:
        webhook = hook(database, there.url())
        event = queue(database, foxes)
        time = now()
        assert deliver_due(database, HERE, time) == 1
        first = stored(database, event)
        assert first.problem == "it answered with status 500"
        assert deliver_due(database, HERE, time + timedelta(seconds=4)) == 0  # too early

        again = Database(database.url.render_as_string(hide_password=False))
        for attempt in (2, 3):
            due_at = stored(again, event).next_at
            assert due_at is not None
            assert deliver_due(again, HERE, due_at) == 1
            assert stored(again, event).attempts == attempt
        again.close()

    assert {headers["webhook-id"] for headers, _ in there.got} == {event}
    assert len(there.got) == 3
    for headers, body in there.got:  # each signed with the time of its attempt
        moment = datetime.fromtimestamp(int(headers["webhook-timestamp"]), UTC)
        assert headers["webhook-signature"] == Verifier(webhook.secret).sign(event, moment, body)
    assert len({headers["webhook-timestamp"] for headers, _ in there.got}) == 3
    assert stored(database, event).delivered is not None


def test_pauses_grow_fourfold_and_differ_by_message() -> None:
    start = now()
    pauses = [(next_attempt("msg_a", count, start) or start) - start for count in range(1, MAX_ATTEMPTS)]
    for count, pause in enumerate(pauses):
        assert 5.0 * 4**count <= pause.total_seconds() <= 5.0 * 4**count * 1.25
    assert next_attempt("msg_a", MAX_ATTEMPTS, start) is None
    first, again, other = (next_attempt(message, 1, start) for message in ("msg_a", "msg_a", "msg_b"))
    assert first == again != other


def test_a_webhook_is_disabled_after_three_lost_messages_and_used_again_after_a_test_that_arrives(
    database: Database, foxes: int
) -> None:
    with receiver(*[500] * MAX_ATTEMPTS * 3) as there:
        webhook = hook(database, there.url())
        time = now()
        for _ in range(3):
            assert disabled(database, webhook) is None
            event = queue(database, foxes, at=time)
            while (due_at := stored(database, event).next_at) is not None:
                deliver_due(database, HERE, max(time, due_at))
                time = max(time, due_at)

        assert len(there.got) == MAX_ATTEMPTS * 3
        why = "3 messages in a row did not arrive: it answered with status 500"
        assert disabled(database, webhook) == why
        with database.writing() as session:
            assert queue_message(session, foxes, "submission.active", DATA, time) == []
            queue_for(session, session.get_one(Webhook, webhook.id), "webhook.test", {}, time)
        assert deliver_due(database, HERE, time) == 1

    assert disabled(database, webhook) is None
    assert json.loads(there.got[-1][1])["type"] == "webhook.test"
    with database.writing() as session:
        assert len(queue_message(session, foxes, "submission.active", DATA, time)) == 1


def test_a_receiver_that_wants_nothing_more_gets_nothing_more(database: Database, foxes: int) -> None:
    with receiver(410) as there:
        webhook = hook(database, there.url())
        queue(database, foxes)
        waiting = queue(database, foxes)
        assert deliver_due(database, HERE, now()) == 1
        assert deliver_due(database, HERE, now() + timedelta(days=1)) == 0

    assert len(there.got) == 1
    assert "wants no more messages" in str(disabled(database, webhook))
    assert stored(database, waiting).next_at is None


def test_what_a_receiver_says_is_neither_followed_nor_read(database: Database, foxes: int) -> None:
    with receiver() as elsewhere, receiver(302, Location=elsewhere.url()) as there:
        hook(database, there.url())
        event = queue(database, foxes)
        deliver_due(database, HERE, now())

    assert elsewhere.got == []
    assert stored(database, event).problem == "it answered with status 302"


def test_a_receiver_that_never_answers_costs_its_own_message_alone(
    database: Database, foxes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wildscav_leaderboard.webhooks.sending.TIME", 1.0)
    with receiver() as there, socket.create_server(("127.0.0.1", 0)) as silent:
        hook(database, f"http://127.0.0.1:{silent.getsockname()[1]}/")
        hook(database, there.url())
        with database.writing() as session:
            lost, arrived = queue_message(session, foxes, "submission.active", DATA, now())

        assert deliver_due(database, HERE, now()) == 2

    assert stored(database, lost.event).problem == "there was no answer within 1 s"
    assert stored(database, arrived.event).delivered is not None


def test_a_private_address_gets_nothing_unless_that_is_allowed(
    database: Database, foxes: int, there: Receiver
) -> None:
    hook(database, there.url("2130706433"))  # 127.0.0.1 as one number
    event = queue(database, foxes)
    deliver_due(database, Webhooks(), now())
    assert there.got == []
    assert "not on the public internet" in stored(database, event).problem
    deliver_due(database, HERE, now() + timedelta(minutes=1))
    assert len(there.got) == 1


@pytest.fixture
def rebinding(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """A name that is 127.0.0.2 the first time it is looked up, and then 127.0.0.1. Returns its lookups."""
    lookups: list[str] = []
    there = socket.getaddrinfo

    def look_up(host: Any, port: Any, *more: Any, **others: Any) -> Any:
        if host in ("localhost", b"localhost"):
            lookups.append(str(host))
            host = "127.0.0.2" if len(lookups) == 1 else "127.0.0.1"
        return there(host, port, *more, **others)

    monkeypatch.setattr(socket, "getaddrinfo", look_up)
    return lookups


def test_a_name_is_looked_up_once_and_the_connection_goes_to_what_was_checked(
    database: Database, foxes: int, rebinding: list[str]
) -> None:
    with receiver(host="127.0.0.2") as checked:
        hook(database, checked.url("localhost"))
        event = queue(database, foxes)
        deliver_due(database, HERE, now())

    assert rebinding == ["localhost"]
    assert stored(database, event).problem == ""
    assert checked.got[0][0]["host"] == f"localhost:{checked.port}"


def test_certificates_are_checked_for_the_name_although_the_connection_goes_to_an_address(
    database: Database, foxes: int, rebinding: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    authority = Authority(tmp_path, "organizers")
    with receiver(host="127.0.0.2", pair=authority.sign("receiver")) as there:
        hook(database, there.url("localhost", "https"))
        stranger = queue(database, foxes)
        deliver_due(database, HERE, now())
        assert "certificate verify failed" in stored(database, stranger).problem
        rebinding.clear()
        monkeypatch.setenv("SSL_CERT_FILE", str(authority.path))
        trusted = queue(database, foxes)
        deliver_due(database, HERE, now())

        assert stored(database, trusted).problem == ""
    assert len(there.got) == 1


def test_a_webhook_that_is_removed_takes_its_messages_with_it(
    database: Database, foxes: int, there: Receiver
) -> None:
    webhook = hook(database, there.url())
    queue(database, foxes)
    with database.writing() as session:
        (message,) = delivery.due(session, now())
        remove_webhook(session, find_team(session, "foxes"), webhook.id)
    assert deliver_due(database, HERE, now()) == 0
    assert there.got == []
    with database.writing() as session:  # nor is an answer kept that comes after that
        delivery.note(session, delivery.Answer(message.delivery, "it was late"), now())


def test_the_thread_sends_what_is_queued_while_it_runs(
    database: Database, foxes: int, there: Receiver
) -> None:
    hook(database, there.url())
    with Deliverer(database, HERE):
        events = {queue(database, foxes, kind=f"submission.{state}") for state in ("queued", "active")}
        assert there.arrived.acquire(timeout=60)
        assert there.arrived.acquire(timeout=60)

    assert {headers["webhook-id"] for headers, _ in there.got} == events


@pytest.mark.parametrize("url", ["http://192.0.2.1:70000/x", "http://xn--/", "http://xn--a/"])
def test_an_address_that_cannot_be_an_address_costs_its_own_message_alone(
    database: Database, foxes: int, there: Receiver, url: str
) -> None:
    with database.writing() as session:  # as versions before this one stored it
        session.add(Webhook(team_id=foxes, url=url, secret="whsec_AAAA", created=now()))  # noqa: S106
    hook(database, there.url())
    with database.writing() as session:
        lost, arrived = queue_message(session, foxes, "submission.active", DATA, now())

    assert deliver_due(database, HERE, now()) == 2

    failed = stored(database, lost.event)
    assert (failed.problem.startswith("it cannot be reached: "), failed.next_at is None) == (True, False)
    assert stored(database, arrived.event).delivered is not None


def test_a_name_that_is_looked_up_slowly_holds_up_nobody_else(
    database: Database, foxes: int, there: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    answered, look_up = threading.Event(), socket.getaddrinfo

    def slow(host: Any, *more: Any, **others: Any) -> Any:
        if host in ("slow.test", b"slow.test"):
            answered.wait(60)
        return look_up(host, *more, **others)

    monkeypatch.setattr(socket, "getaddrinfo", slow)
    hook(database, "http://slow.test/")
    with Deliverer(database, HERE):
        queue(database, foxes)
        hook(database, there.url())
        for _ in range(3):
            with database.writing() as session:
                queue_message(session, foxes, "submission.active", DATA, now())
            assert there.arrived.acquire(timeout=30)
        answered.set()


def test_nothing_is_sent_where_webhooks_are_not_enabled(
    database: Database, foxes: int, there: Receiver
) -> None:
    hook(database, there.url())
    event = queue(database, foxes)
    with Deliverer(database, Webhooks(enabled=False, private_addresses=True)):
        pass
    assert there.got == []
    assert stored(database, event).attempts == 0
