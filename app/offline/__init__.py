"""The service's work without the service: the same requests and the same tasks, files in and files out."""
