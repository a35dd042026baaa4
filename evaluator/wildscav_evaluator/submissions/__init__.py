"""Submissions: folders, archives and images, checked before any of their code runs."""
