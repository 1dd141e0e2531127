"""Measured and simulated pairs of loads and motions of sliding parts."""
