"""The commands of a season: `wildscav season …`."""
