"""The compliance suite: what `wildscav check` tries with a submission, and what it says of it."""
