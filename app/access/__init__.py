"""Who may ask for what: named tokens, their scopes, and the record of what was asked."""
