"""The addresses of a server: who may connect, with what certificate or token, and which calls are served."""
