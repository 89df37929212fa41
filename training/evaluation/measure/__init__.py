"""From photographs to rows of the table.

- `table`: a row for each photograph and estimator, on disk.
- `figures`: the columns of a row.
- `simulated`: P0, P2 and P3.
- `real`: P4.
- `unusual`: P6.
"""
