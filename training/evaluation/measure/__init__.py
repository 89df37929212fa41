"""From photographs to rows of the table.

- `table`: a row for each photograph and estimator, on disk.
- `figures`: the columns of a row.
- `simulated`: P0, P2 and the experiments of the paper.
- `real`: P4.
- `unusual`: P6.
"""
