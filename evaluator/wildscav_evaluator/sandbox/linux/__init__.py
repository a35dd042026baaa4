"""The isolation of Linux itself: namespaces, control groups and filters of system calls."""
