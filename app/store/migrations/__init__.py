"""The history of the tables. Add a module to `versions` for every change of `app.store.rows`."""
