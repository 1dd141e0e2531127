"""Self-contained pages about a run."""
