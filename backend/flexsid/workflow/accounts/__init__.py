"""Accounts of a team: names, passwords, memberships, sessions and tokens."""
