"""Every route of a season's application, and what everyone who may ask it is answered with."""

import json
import re
from typing import Any, NamedTuple

from tests.leaderboard.filled_season import PASSWORD

ASKING = ("visitor", "other", "owner", "organizer")  # other has an account, but no team
LOG_IN = 303  # to the page on which one logs in


class Line(NamedTuple):
    """A route, and what each who asks is answered with."""

    route: str
    path: str  # with places for what is in the season
    statuses: tuple[int, ...]  # of ASKING
    body: Any = None  # JSON for the API, the fields of a form for a page

    @property
    def method(self) -> str:
        return self.route.partition(" ")[0]

    @property
    def is_page(self) -> bool:
        return not self.path.startswith("/api/")


def _line(text: str) -> Line:
    """Read a line: ``{track=battle}`` in its path is a value, ``{number=@active}`` what is in the season."""
    first, second, third, fourth, method, path, *body = text.split(None, 6)
    route = re.sub(r"=[^}]*", "", path.partition("?")[0]).removesuffix("{}")
    asked = re.sub(r"\{[^{}=]*=(@?)([^}]*)\}", lambda one: f"{{{one[2]}}}" if one[1] else one[2], path)
    statuses = tuple(map(int, (first, second, third, fourth)))
    return Line(f"{method} {route}", asked, statuses, json.loads(body[0]) if body else None)


# 503 is the answer of what would be rendered for them, if the server were not stopping.
TABLE = tuple(
    _line(line.replace("PASSWORD", PASSWORD))
    for line in """
200 200 200 200 GET /api/v1/openapi.json
200 200 200 200 GET /api/v1/season
200 200 200 200 GET /api/v1/boards
200 200 200 200 GET /api/v1/boards/{track=battle}
401 403 403 200 GET /api/v1/boards/{track=battle}?audience=hidden
200 200 200 200 GET /api/v1/boards/{track=battle}/history?submission={active}
200 200 200 200 GET /api/v1/boards/{track=battle}/history?team=owls&team=foxes
200 200 200 200 GET /api/v1/boards/{track=battle}/head-to-head
404 404 404 404 GET /api/v1/boards/{track=navigation}/head-to-head
401 403 403 200 GET /api/v1/organizer/status
401 403 403 200 GET /api/v1/organizer/audit-log
401 403 403 200 GET /api/v1/organizer/accounts
401 403 403 204 POST /api/v1/organizer/pause {"reason": "a new disk"}
401 403 403 409 POST /api/v1/organizer/resume
401 403 403 204 POST /api/v1/organizer/freeze
401 403 403 409 POST /api/v1/organizer/unfreeze
401 403 403 204 POST /api/v1/organizer/rejudge {"track": "navigation"}
401 403 403 204 POST /api/v1/organizer/announcements {"title": "Welcome"}
401 403 403 201 POST /api/v1/organizer/invitations {}
401 403 403 404 POST /api/v1/organizer/submissions/{number=9999}/rerun
401 403 403 200 POST /api/v1/organizer/submissions/{number=@active}/disqualify {"reason": "it reads the map"}
401 403 403 409 POST /api/v1/organizer/submissions/{number=@active}/requalify {"reason": "a mistake"}
401 403 403 409 POST /api/v1/organizer/submissions/{number=@active}/reactivate {"reason": "a mistake"}
401 403 403 204 POST /api/v1/organizer/teams/{name=owls}/disqualify {"reason": "it reads the map"}
401 403 403 409 POST /api/v1/organizer/teams/{name=owls}/requalify {"reason": "a mistake"}
401 403 403 204 POST /api/v1/organizer/matches/{number=@ladder}/hide {"reason": "an insult"}
401 403 403 409 POST /api/v1/organizer/matches/{number=@suite}/unhide
401 403 403 204 POST /api/v1/organizer/accounts/{name=owls}/disable {"reason": "a second account"}
401 403 403 409 POST /api/v1/organizer/accounts/{name=owls}/enable
401 403 403 200 POST /api/v1/organizer/accounts/{name=owls}/password
200 200 200 200 GET /api/v1/audit/season.json
200 200 200 200 GET /api/v1/audit/tracks/{track=battle}.ndjson
404 404 404 404 GET /api/v1/audit/tracks/{track=royale}.ndjson
200 200 200 200 GET /api/v1/announcements
201 201 201 201 POST /api/v1/accounts {"name": "somebody", "password": "PASSWORD"}
201 201 201 201 POST /api/v1/tokens {"name": "owls", "password": "PASSWORD"}
401 200 200 200 GET /api/v1/tokens
401 404 204 404 DELETE /api/v1/tokens/{token=@owners_token}
401 204 204 204 DELETE /api/v1/tokens/current
401 200 200 200 GET /api/v1/me
200 200 200 200 GET /api/v1/teams
401 201 409 201 POST /api/v1/teams {"name": "storks"}
401 403 409 403 POST /api/v1/teams/join {"key": "team_guessed"}
401 409 204 409 POST /api/v1/teams/leave
401 403 200 403 POST /api/v1/teams/mine/key
200 200 200 200 GET /api/v1/teams/{name=owls}
401 403 200 403 GET /api/v1/webhooks
401 403 201 403 POST /api/v1/webhooks {"url": "https://example.org/"}
401 403 204 403 DELETE /api/v1/webhooks/{webhook=1}
401 403 202 403 POST /api/v1/webhooks/{webhook=1}/test
401 403 422 403 POST /api/v1/submissions "no archive"
200 200 200 200 GET /api/v1/submissions
200 200 200 200 GET /api/v1/submissions/{submission=@failed}
401 404 200 200 POST /api/v1/submissions/{submission=@queued}/{act=cancel}
401 404 200 200 GET /api/v1/submissions/{submission=@failed}/logs
200 200 200 200 GET /api/v1/submissions/{submission=@active}/opponents?track=battle
200 200 200 200 GET /api/v1/matches
200 200 200 200 GET /api/v1/matches/{match=@suite}
403 403 403 200 GET /api/v1/matches/{match=@own_suite}/record
200 200 200 200 GET /api/v1/matches/{match=@ladder}/record
403 403 403 200 GET /api/v1/matches/{match=@own_suite}/notes
200 200 200 200 GET /api/v1/matches/{match=@ladder}/notes
403 403 403 403 GET /api/v1/matches/{match=@own_suite}/live
403 403 403 503 GET /api/v1/matches/{match=@own_suite}/trails
403 403 403 503 GET /api/v1/matches/{match=@own_suite}/map
403 403 403 503 GET /api/v1/matches/{match=@own_suite}/replay
403 403 403 503 GET /api/v1/matches/{match=@own_suite}/replay.rrd
403 403 403 503 GET /api/v1/matches/{match=@own_suite}/poster.jpg
403 403 403 503 GET /api/v1/matches/{match=@own_suite}/video
403 403 403 503 GET /api/v1/matches/{match=@own_suite}/video.mp4
401 404 403 200 GET /api/v1/matches/{match=@own_suite}/logs/{seat=0}
404 404 404 404 GET /viewer/{viewer=0.0.0}/{name:path=index.html}
200 200 200 200 GET /
200 200 200 200 GET /boards/{track=navigation}
200 200 200 200 GET /boards/{track=battle}
303 403 403 200 GET /boards/{track=battle}?audience=hidden
200 200 200 200 GET /boards/{track=battle}/head-to-head
404 404 404 404 GET /boards/{track=navigation}/head-to-head
200 200 200 200 GET /feeds/announcements.atom
200 200 200 200 GET /feeds/{track=battle}.atom
200 200 200 200 GET /badges/{track=battle}/teams/{name=owls}.svg
200 200 200 200 GET /badges/{track=battle}/submissions/{number=@active}.svg
200 200 200 200 GET /teams/{name=owls}
200 200 200 200 GET /teams/{name=newts}
200 200 200 200 GET /submissions/{number=@failed}
200 200 200 200 GET /submissions/{number=@active}
200 200 200 200 GET /matches
200 200 200 200 GET /matches?track=battle&team=owls&state=finished&before=200
404 404 404 404 GET /matches?team=nobody
422 422 422 422 GET /matches?state=odd
200 200 200 200 GET /matches/{number=@suite}
200 200 200 200 GET /matches/{number=@ladder}
200 200 200 200 GET /robots.txt
403 403 403 503 GET /matches/{number=@suite}/video
503 503 503 503 GET /matches/{number=@ladder}/video
403 403 403 503 GET /matches/{number=@suite}/watch
503 503 503 503 GET /matches/{number=@ladder}/watch
200 200 200 200 GET /login
303 303 303 303 POST /login {"name": "owls", "password": "PASSWORD"}
303 303 303 303 POST /logout {}
200 200 200 200 GET /register
303 303 303 303 POST /register {"name": "somebody", "password": "PASSWORD"}
303 200 200 200 GET /account
303 200 200 200 POST /account {"act": "token", "value": "desk"}
303 200 200 200 GET /submit
303 403 422 403 POST /submit "no archive"
303 404 303 303 POST /submissions/{number=@queued}/{act=cancel} {}
403 403 403 403 POST /submissions/{number=@active}/play {"track": "battle"}
403 403 403 403 GET /play
403 403 403 403 POST /play {"code": "BCDFGH"}
404 404 404 404 POST /play/{secret=guessed}/join {"code": "BCDFGH"}
404 404 404 404 GET /play/{secret=guessed}/{path:path=play/guessed}
404 404 404 404 SOCKET /play/{secret=guessed}/{path:path=play/guessed/socket}
303 403 403 200 GET /organizer
303 403 403 200 GET /organizer/submissions
303 403 403 200 GET /organizer/submissions?state=failed&before=9
303 403 403 200 GET /organizer/teams
303 403 403 200 GET /organizer/people
303 403 403 200 GET /organizer/announcements
303 403 403 200 GET /organizer/audit-log
303 403 403 303 POST /organizer {"act": "freeze"}
303 403 403 200 POST /organizer {"act": "invite", "label": "a friend"}
303 403 403 409 POST /organizer {"act": "resume"}
200 200 200 200 FILES /static{=/season.css}
200 200 200 200 FILES /stage{=/viewer.js}
200 200 200 200 GET /health
200 200 200 200 GET /ready
""".strip().splitlines()
)
