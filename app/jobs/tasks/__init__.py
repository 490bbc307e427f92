"""One module per kind of job: `<kind>.py` with `KIND` and `run(payload, context)`, see `app.jobs.task`."""
