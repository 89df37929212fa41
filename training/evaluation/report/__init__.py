"""From rows of the table to a report.

- `cases`: photographs with the figures of several estimators, and 95 % intervals by resampling.
- `summary`: the figures of one estimator on one group of photographs.
- `rows`: these figures for all groups, protocol by protocol.
- `document`: report.json.
- `markdown`: report.md.
- `paper`: the figures of the CRF-net paper.
"""
