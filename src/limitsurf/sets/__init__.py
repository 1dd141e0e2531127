"""Convex sets in load space."""
