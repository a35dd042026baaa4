"""What is needed of the operating system: worker processes, limited processes, temporary files, folders."""
