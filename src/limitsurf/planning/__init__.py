"""The macroscopic planner: turn and squeeze functions, alignment plans, verification."""
