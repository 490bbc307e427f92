"""HTTP operations: parse, call, return. Every module with an attribute `router` is served under /v1."""
