"""The report: what it holds, and how it is written.

- `errors`: the three errors, their intervals, summaries and differences.
- `content`: the whole report, protocol by protocol.
- `document`: report.json, written and read back.
- `markdown`: report.md; `markdown_stress`, `markdown_real` and `markdown_tables` are parts of it.
- `plots`, `real_plots`: the PNGs.
- `accuracy`: what model.json and the model card say of a report.
- `paper`: the figures of the CRF-net paper, which stand beside ours.
"""
