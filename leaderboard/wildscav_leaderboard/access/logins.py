"""Logging in with a name and a password, which nobody may guess and nobody may keep others from."""

import asyncio

from starlette.concurrency import run_in_threadpool

from wildscav_leaderboard.access.rate_limits import TRIES, RateLimits
from wildscav_leaderboard.accounts import passwords
from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.accounts.service import check_usable, find_account
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.refusals import UnknownCallerError

AT_ONCE = 5  # tries of a name in a minute; each of those after them waits twice as long as the one before it
LONGEST_PAUSE = 8.0  # s


async def log_in(database: Database, address: str, name: str, password: str) -> Account:
    """Return the account with a name and a password.

    An address that gave ten wrong ones is refused for a minute. A name is never refused, because anyone could
    lock anybody out that way: it answers more slowly with every try. No thread waits meanwhile.

    Raises:
        TooMuchError: The address gave too many wrong passwords.
        UnknownCallerError: There is no such account, or the password is wrong; it does not say which.
        ForbiddenError: The account is disabled.
    """
    limits = RateLimits(database)
    await run_in_threadpool(limits.use, TRIES, "address", address)
    await asyncio.sleep(pause(await run_in_threadpool(limits.use, None, "name", name)))
    account = await run_in_threadpool(_checked, database, name, password)
    await run_in_threadpool(limits.take_back, "address", address)
    return account


def pause(tries: int) -> float:
    """Return how long a try of a name waits after some others in the last minute, s."""
    return 0.0 if tries < AT_ONCE else min(LONGEST_PAUSE, 2.0 ** (tries - AT_ONCE))


def _checked(database: Database, name: str, password: str) -> Account:
    with database.reading() as session:
        account = find_account(session, name)
    if not passwords.matches(password, None if account is None else account.password) or account is None:
        raise UnknownCallerError("the name or the password is wrong")
    return check_usable(account)
