"""Actuators, arrays of them, and activations."""
