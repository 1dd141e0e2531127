"""Convex programs as plain data, solved by Clarabel through cvxpy: the slow truth."""
