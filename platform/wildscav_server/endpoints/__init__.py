"""The addresses of a server: who may connect, with which certificate or token, and which calls are served."""
