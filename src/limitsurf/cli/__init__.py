"""The limitsurf command."""
