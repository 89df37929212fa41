"""Faults at single calls of the system: `python -m tests.faults` makes each write of `estimate` fail once."""
