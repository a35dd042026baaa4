"""Webhooks: messages to a team's own address when the state of one of its submissions changes."""
