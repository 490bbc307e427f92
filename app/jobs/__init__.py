"""The ledger of jobs and the executor that runs them in limited child processes."""
