"""Every route of a season's application, and what everyone who may ask it is answered with."""

from typing import Any, NamedTuple

from tests.leaderboard.filled_season import PASSWORD

ASKING = ("visitor", "other", "owner", "organizer")  # other has an account, but no team
LOG_IN = 303  # to the page on which one logs in
NOT_NOW = 503  # of what would be rendered for them, if the server were not stopping


class Line(NamedTuple):
    """A route, and what each who asks is answered with."""

    route: str
    path: str  # with places for what is in the season
    statuses: tuple[int, int, int, int]  # of ASKING
    body: Any = None  # JSON for the API, the fields of a form for a page

    @property
    def method(self) -> str:
        return self.route.partition(" ")[0]

    @property
    def is_page(self) -> bool:
        return not self.path.startswith("/api/")


def everyone(route: str, path: str = "", status: int = 200, body: Any = None) -> Line:
    return _line(route, path, (status,) * 4, body)


def known(route: str, path: str = "", status: int = 200, body: Any = None) -> Line:
    return _line(route, path, (401, status, status, status), body)


def of_team(route: str, path: str = "", status: int = 200, body: Any = None) -> Line:
    """Of a member of a team: the others have none."""
    return _line(route, path, (401, 403, status, 403), body)


def logged_in(route: str, path: str = "", status: int = 200, body: Any = None) -> Line:
    return _line(route, path, (LOG_IN, status, status, status), body)


def organizers(route: str, path: str = "", status: int = 200, body: Any = None) -> Line:
    visitor = 401 if " /api/" in route else LOG_IN
    return _line(route, path, (visitor, 403, 403, status), body)


def each(route: str, path: str, *statuses: int, body: Any = None) -> Line:
    return _line(route, path, statuses, body)


def _line(route: str, path: str, statuses: tuple[int, ...], body: Any) -> Line:
    first, second, third, fourth = statuses
    return Line(route, path or route.partition(" ")[2], (first, second, third, fourth), body)


NAMED = {"name": "somebody", "password": PASSWORD}
OWLS = {"name": "owls", "password": PASSWORD}
TABLE = (
    everyone("GET /api/v1/openapi.json"),
    everyone("GET /api/v1/season"),
    everyone("GET /api/v1/boards"),
    everyone("GET /api/v1/boards/{track}", "/api/v1/boards/battle"),
    each("GET /api/v1/boards/{track}", "/api/v1/boards/battle?audience=hidden", 401, 403, 403, 200),
    everyone("GET /api/v1/boards/{track}/history", "/api/v1/boards/battle/history?submission={active}"),
    organizers("GET /api/v1/organizer/status"),
    organizers("GET /api/v1/organizer/audit-log"),
    organizers("POST /api/v1/organizer/pause", "", 204, {"reason": "a new disk"}),
    organizers("POST /api/v1/organizer/resume", "", 409),
    organizers("POST /api/v1/organizer/freeze", "", 204),
    organizers("POST /api/v1/organizer/unfreeze", "", 409),
    organizers("POST /api/v1/organizer/rejudge", "", 204, {"track": "navigation"}),
    organizers("POST /api/v1/organizer/announcements", "", 204, {"title": "Welcome"}),
    organizers("POST /api/v1/organizer/invitations", "", 201, {}),
    organizers(
        "POST /api/v1/organizer/submissions/{number}/rerun", "/api/v1/organizer/submissions/9999/rerun", 404
    ),
    organizers(
        "POST /api/v1/organizer/submissions/{number}/disqualify",
        "/api/v1/organizer/submissions/{active}/disqualify",
        200,
        {"reason": "it reads the map"},
    ),
    organizers(
        "POST /api/v1/organizer/teams/{name}/disqualify",
        "/api/v1/organizer/teams/owls/disqualify",
        204,
        {"reason": "it reads the map"},
    ),
    organizers(
        "POST /api/v1/organizer/matches/{number}/hide",
        "/api/v1/organizer/matches/{ladder}/hide",
        204,
        {"reason": "an insult"},
    ),
    organizers(
        "POST /api/v1/organizer/matches/{number}/unhide", "/api/v1/organizer/matches/{suite}/unhide", 409
    ),
    organizers(
        "POST /api/v1/organizer/teams/{name}/requalify",
        "/api/v1/organizer/teams/owls/requalify",
        409,
        {"reason": "a mistake"},
    ),
    *(
        organizers(
            f"POST /api/v1/organizer/submissions/{{number}}/{act}",
            f"/api/v1/organizer/submissions/{{active}}/{act}",
            409,
            {"reason": "a mistake"},
        )
        for act in ("requalify", "reactivate")
    ),
    organizers("GET /api/v1/organizer/accounts"),
    organizers(
        "POST /api/v1/organizer/accounts/{name}/disable",
        "/api/v1/organizer/accounts/owls/disable",
        204,
        {"reason": "a second account"},
    ),
    organizers(
        "POST /api/v1/organizer/accounts/{name}/enable", "/api/v1/organizer/accounts/owls/enable", 409
    ),
    organizers(
        "POST /api/v1/organizer/accounts/{name}/password", "/api/v1/organizer/accounts/owls/password", 200
    ),
    everyone("GET /api/v1/audit/season.json"),
    everyone("GET /api/v1/audit/tracks/{track}.ndjson", "/api/v1/audit/tracks/battle.ndjson"),
    everyone("GET /api/v1/audit/tracks/{track}.ndjson", "/api/v1/audit/tracks/royale.ndjson", 404),
    everyone("GET /api/v1/boards/{track}/history", "/api/v1/boards/battle/history?team=owls&team=foxes"),
    everyone("GET /api/v1/boards/{track}/head-to-head", "/api/v1/boards/battle/head-to-head"),
    everyone("GET /api/v1/boards/{track}/head-to-head", "/api/v1/boards/navigation/head-to-head", 404),
    everyone("GET /api/v1/announcements"),
    everyone("POST /api/v1/accounts", "", 201, NAMED),
    everyone("POST /api/v1/tokens", "", 201, OWLS),
    known("GET /api/v1/tokens"),
    each("DELETE /api/v1/tokens/{token}", "/api/v1/tokens/{owners_token}", 401, 404, 204, 404),
    known("DELETE /api/v1/tokens/current", "", 204),
    known("GET /api/v1/me"),
    everyone("GET /api/v1/teams"),
    each("POST /api/v1/teams", "", 401, 201, 409, 201, body={"name": "storks"}),
    each("POST /api/v1/teams/join", "", 401, 403, 409, 403, body={"key": "team_guessed"}),
    each("POST /api/v1/teams/leave", "", 401, 409, 204, 409),
    of_team("POST /api/v1/teams/mine/key"),
    everyone("GET /api/v1/teams/{name}", "/api/v1/teams/owls"),
    of_team("GET /api/v1/webhooks"),
    of_team("POST /api/v1/webhooks", "", 201, {"url": "https://example.org/"}),
    of_team("DELETE /api/v1/webhooks/{webhook}", "/api/v1/webhooks/1", 204),
    of_team("POST /api/v1/webhooks/{webhook}/test", "/api/v1/webhooks/1/test", 202),
    each("POST /api/v1/submissions", "", 401, 403, 422, 403, body="no archive"),
    everyone("GET /api/v1/submissions"),
    everyone("GET /api/v1/submissions/{submission}", "/api/v1/submissions/{failed}"),
    each(
        "POST /api/v1/submissions/{submission}/{act}",
        "/api/v1/submissions/{queued}/cancel",
        *(401, 404, 200, 200),
    ),
    each(
        "GET /api/v1/submissions/{submission}/logs", "/api/v1/submissions/{failed}/logs", 401, 404, 200, 200
    ),
    everyone(
        "GET /api/v1/submissions/{submission}/opponents",
        "/api/v1/submissions/{active}/opponents?track=battle",
    ),
    everyone("GET /api/v1/matches"),
    everyone("GET /api/v1/matches/{match}", "/api/v1/matches/{suite}"),
    each("GET /api/v1/matches/{match}/record", "/api/v1/matches/{own_suite}/record", 403, 403, 403, 200),
    everyone("GET /api/v1/matches/{match}/record", "/api/v1/matches/{ladder}/record"),
    each("GET /api/v1/matches/{match}/notes", "/api/v1/matches/{own_suite}/notes", 403, 403, 403, 200),
    everyone("GET /api/v1/matches/{match}/notes", "/api/v1/matches/{ladder}/notes"),
    each("GET /api/v1/matches/{match}/trails", "/api/v1/matches/{own_suite}/trails", 403, 403, 403, NOT_NOW),
    each("GET /api/v1/matches/{match}/live", "/api/v1/matches/{own_suite}/live", 403, 403, 403, 403),
    each(
        "GET /api/v1/matches/{match}/map",
        "/api/v1/matches/{own_suite}/map",
        *(403, 403, 403, NOT_NOW),
    ),
    each("GET /api/v1/matches/{match}/replay", "/api/v1/matches/{own_suite}/replay", 403, 403, 403, NOT_NOW),
    each(
        "GET /api/v1/matches/{match}/replay.rrd",
        "/api/v1/matches/{own_suite}/replay.rrd",
        403,
        403,
        403,
        NOT_NOW,
    ),
    each(
        "GET /api/v1/matches/{match}/poster.jpg",
        "/api/v1/matches/{own_suite}/poster.jpg",
        *(403, 403, 403, NOT_NOW),
    ),
    each("GET /api/v1/matches/{match}/video", "/api/v1/matches/{own_suite}/video", 403, 403, 403, NOT_NOW),
    each(
        "GET /api/v1/matches/{match}/video.mp4",
        "/api/v1/matches/{own_suite}/video.mp4",
        *(403, 403, 403, NOT_NOW),
    ),
    each("GET /api/v1/matches/{match}/logs/{seat}", "/api/v1/matches/{own_suite}/logs/0", 401, 404, 403, 200),
    everyone("GET /viewer/{viewer}/{name:path}", "/viewer/0.0.0/index.html", 404),
    everyone("GET /"),
    everyone("GET /boards/{track}", "/boards/navigation"),
    everyone("GET /boards/{track}", "/boards/battle"),
    organizers("GET /boards/{track}", "/boards/battle?audience=hidden"),
    everyone("GET /boards/{track}/head-to-head", "/boards/battle/head-to-head"),
    everyone("GET /boards/{track}/head-to-head", "/boards/navigation/head-to-head", 404),
    everyone("GET /feeds/announcements.atom"),
    everyone("GET /feeds/{track}.atom", "/feeds/battle.atom"),
    everyone("GET /badges/{track}/teams/{name}.svg", "/badges/battle/teams/owls.svg"),
    everyone("GET /badges/{track}/submissions/{number}.svg", "/badges/battle/submissions/{active}.svg"),
    everyone("GET /teams/{name}", "/teams/owls"),
    everyone("GET /teams/{name}", "/teams/newts"),
    everyone("GET /submissions/{number}", "/submissions/{failed}"),
    everyone("GET /submissions/{number}", "/submissions/{active}"),
    everyone("GET /matches"),
    everyone("GET /matches", "/matches?track=battle&team=owls&state=finished&before=200"),
    everyone("GET /matches", "/matches?team=nobody", 404),
    everyone("GET /matches", "/matches?state=odd", 422),
    everyone("GET /matches/{number}", "/matches/{suite}"),
    everyone("GET /matches/{number}", "/matches/{ladder}"),
    everyone("GET /robots.txt"),
    each("GET /matches/{number}/video", "/matches/{suite}/video", 403, 403, 403, NOT_NOW),
    everyone("GET /matches/{number}/video", "/matches/{ladder}/video", NOT_NOW),
    each("GET /matches/{number}/watch", "/matches/{suite}/watch", 403, 403, 403, NOT_NOW),
    everyone("GET /matches/{number}/watch", "/matches/{ladder}/watch", NOT_NOW),
    everyone("GET /login"),
    everyone("POST /login", "", 303, OWLS),
    logged_in("POST /logout", "", 303, {}),
    everyone("GET /register"),
    everyone("POST /register", "", 303, NAMED),
    logged_in("GET /account"),
    logged_in("POST /account", "", 200, {"act": "token", "value": "desk"}),
    logged_in("GET /submit"),
    each("POST /submit", "", LOG_IN, 403, 422, 403, body="no archive"),
    each("POST /submissions/{number}/{act}", "/submissions/{queued}/cancel", LOG_IN, 404, 303, 303, body={}),
    everyone("POST /submissions/{number}/play", "/submissions/{active}/play", 403, {"track": "battle"}),
    everyone("GET /play", "", 403),
    everyone("POST /play", "", 403, {"code": "BCDFGH"}),
    everyone("POST /play/{secret}/join", "/play/guessed/join", 404, {"code": "BCDFGH"}),
    everyone("GET /play/{secret}/{path:path}", "/play/guessed/play/guessed", 404),
    everyone("SOCKET /play/{secret}/{path:path}", "/play/guessed/play/guessed/socket", 404),
    organizers("GET /organizer"),
    organizers("GET /organizer/submissions"),
    organizers("GET /organizer/submissions", "/organizer/submissions?state=failed&before=9"),
    organizers("GET /organizer/teams"),
    organizers("GET /organizer/people"),
    organizers("GET /organizer/announcements"),
    organizers("GET /organizer/audit-log"),
    organizers("POST /organizer", "", 303, {"act": "freeze"}),
    organizers("POST /organizer", "", 200, {"act": "invite", "label": "a friend"}),
    organizers("POST /organizer", "", 409, {"act": "resume"}),
    everyone("FILES /static", "/static/season.css"),
    everyone("FILES /stage", "/stage/viewer.js"),
    everyone("GET /health"),
    everyone("GET /ready"),
)
