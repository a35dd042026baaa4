"""The REST API: its routes and the documents that it answers with."""
