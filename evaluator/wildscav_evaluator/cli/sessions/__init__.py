"""What a user sees while a command runs: progress, results, and errors."""
