"""The hooks that MkDocs calls while it builds the website; the package beside this file implements them."""

from wildscav_website.build import on_files, on_page_markdown

__all__ = ["on_files", "on_page_markdown"]
