"""What a user sees while a command runs: progress, results, and what went wrong."""
