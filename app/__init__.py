"""The service around identification and oed: HTTP, jobs, storage, command line."""

__version__ = "0.1.0"
