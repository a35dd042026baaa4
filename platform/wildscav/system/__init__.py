"""Operating system services: worker processes, limited processes, temporary files and folders."""
