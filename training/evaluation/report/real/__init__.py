"""The part of the report on real photographs, P4.

- `content`: what the report holds of it.
- `markdown`: its section of report.md.
- `photographs`: the tables of single photographs in that section.
- `plots`: the PNGs: every photograph beside its measured and its estimated response.
"""
