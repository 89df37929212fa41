"""From figures of photographs to what the report says of them, with confidence intervals.

- `bootstrap`: 95 % intervals by resampling scenes and responses together.
- `error_table`: the errors of all estimators on the same photographs, side by side, and their summaries.
- `clean`: P0, P1 and P2.
- `stress`: P3.
- `bodies`: P4, means over the bodies of real cameras.
- `emor_weights`: P4, whether the estimated weights follow the true ones.
- `trust`: P4, how often an answer is called usable and is far off.
- `reliability`: P5, whether the uncertainty foretells the error.
"""
