"""Parts and their outlines."""
