"""Motion of a part on an array from event to event."""
