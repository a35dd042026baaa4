"""The compliance suite: what `wildscav check` tests on a submission, and what it reports."""
