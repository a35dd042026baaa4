"""The pages of the site that are made from the code, when MkDocs builds it."""
