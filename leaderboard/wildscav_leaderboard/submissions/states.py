"""The states of a submission, and which may follow which.

    submitted → queued → building → validating → active ⇄ disabled

From every state before ``active`` a submission may also become ``failed`` (by its own fault, or after the
platform broke every attempt) or ``cancelled`` (by its team, or because it is disqualified). ``building`` and
``validating`` go back to ``queued`` when the platform broke the attempt or its deadline passed.
"""

SUBMITTED = "submitted"  # stored; its archive was checked
QUEUED = "queued"  # waits for its turn
BUILDING = "building"  # unpacked, and built into an image if the sandbox needs one
VALIDATING = "validating"  # plays the matches of `wildscav check`
ACTIVE = "active"  # takes part in the season's matches
FAILED = "failed"  # does not take part; `fault` says whose fault it is
CANCELLED = "cancelled"  # withdrawn by its team
DISABLED = "disabled"  # took part; replaced or disabled by its team, or disqualified; may take part again

STATES = (SUBMITTED, QUEUED, BUILDING, VALIDATING, ACTIVE, FAILED, CANCELLED, DISABLED)
ON_THE_WAY = frozenset({SUBMITTED, QUEUED, BUILDING, VALIDATING})
FINAL = frozenset({FAILED, CANCELLED, DISABLED})
FOLLOWING: dict[str, frozenset[str]] = {
    SUBMITTED: frozenset({QUEUED, FAILED, CANCELLED}),
    QUEUED: frozenset({BUILDING, FAILED, CANCELLED}),
    BUILDING: frozenset({VALIDATING, QUEUED, FAILED, CANCELLED}),
    VALIDATING: frozenset({ACTIVE, QUEUED, FAILED, CANCELLED}),
    ACTIVE: frozenset({DISABLED}),
    # An organizer may run a submission again, or let it take part again.
    FAILED: frozenset({QUEUED}),
    CANCELLED: frozenset(),
    DISABLED: frozenset({ACTIVE}),
}
