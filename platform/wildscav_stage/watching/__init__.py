"""Pages that show matches."""
