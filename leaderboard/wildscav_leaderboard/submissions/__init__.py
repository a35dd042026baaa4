"""Submissions: what teams hand in, the states that it goes through, and quotas."""
