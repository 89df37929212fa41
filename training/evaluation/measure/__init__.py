"""From photographs to figures: every estimator (model or baseline) is asked about every photograph.

- `figures`: what is measured of one estimator on one photograph.
- `case_files`: these figures on disk, so that an interrupted evaluation goes on.
- `jobs`: a part of the simulated photographs, taken and measured by one process.
- `simulated`: all simulated photographs, on several processes.
- `real`: all real photographs.
- `pooled`: several photographs of one body, given together.
- `unusual`: pictures that must be refused, and how many are accepted.
- `verdict_files`: these verdicts on disk.
"""
