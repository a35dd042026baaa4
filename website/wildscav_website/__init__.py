"""The pages of the website that are generated from the code when MkDocs builds it."""
