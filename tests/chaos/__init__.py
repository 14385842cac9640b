"""A whole hosted service under faults: `python -m tests.chaos`; `tests.chaos.soak` watches it for an hour."""
