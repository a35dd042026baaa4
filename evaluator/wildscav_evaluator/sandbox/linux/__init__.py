"""What Linux itself isolates with: namespaces, control groups and filters of system calls."""
