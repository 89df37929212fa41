"""From rows of the table to a report.

- `bootstrap`: 95 % intervals by resampling scenes and responses together.
- `summary`: the figures of one estimator on one group of photographs.
- `sums`: these figures for all groups, protocol by protocol.
- `document`: report.json.
- `markdown`: report.md.
- `card`: figures for model.json and the model card.
- `paper`: the figures of the CRF-net paper.
"""
