"""Compiled functions on arrays: no classes, one algorithm a file."""
