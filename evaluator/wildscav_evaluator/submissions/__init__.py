"""Submissions: folders, archives and images, checked before anything of them runs."""
