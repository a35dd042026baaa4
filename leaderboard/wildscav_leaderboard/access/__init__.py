"""Requests: who asks, how often they may, and the season and database that they ask about."""
