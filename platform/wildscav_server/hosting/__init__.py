"""One hosted match: its seats and their time limits, the lockstep, the messages to seats, and the reports."""
