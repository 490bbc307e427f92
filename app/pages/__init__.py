"""The workbench: HTML shells that are filled in the browser from /v1, their scripts and their style."""
