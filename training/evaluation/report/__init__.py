"""The report: what it holds, and how it is written.

- `errors`: the three errors, their intervals, summaries and differences.
- `content`: the whole report, protocol by protocol.
- `document`: report.json, written and read back.
- `markdown`: report.md; `markdown_stress` and `markdown_tables` are parts of it.
- `plots`: the PNGs.
- `real`: what the report holds of real photographs, its section of report.md and its PNGs.
- `unusual`: the same of pictures that no response explains, P6.
- `accuracy`: what model.json and the model card say of a report.
- `paper`: the figures of the CRF-net paper, which stand beside ours.
"""
