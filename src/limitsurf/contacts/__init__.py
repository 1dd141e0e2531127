"""Contacts between a part and what carries it."""
