"""Accounts: who may use the season, their passwords, tokens, web sessions and invitations."""
