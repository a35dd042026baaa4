"""What MkDocs calls while it builds the site; the package beside this file does the work."""

from wildscav_website.build import on_files, on_page_markdown

__all__ = ["on_files", "on_page_markdown"]
