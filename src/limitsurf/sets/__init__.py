"""Convex sets in load space, and in any space of a few dimensions."""
