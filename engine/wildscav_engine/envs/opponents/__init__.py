"""Policies in the seats behind the learners': who plays where, what they observe, and what they do."""
