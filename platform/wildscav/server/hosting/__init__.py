"""One hosted match: its seats, its lockstep, their time limits, what they are sent and what is reported."""
