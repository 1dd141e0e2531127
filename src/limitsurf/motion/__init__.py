"""Motion of parts on arrays."""
