"""The season's database: one interface for SQLite and PostgreSQL, and its schema."""
