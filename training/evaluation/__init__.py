"""Measure models against responses that are known: ``python -m training.evaluation``.

- `__main__`: the command.
- `models`: the models that are measured.
- `test_sets`: scenes and responses, of the data or bundled with the repository.
- `plan`: the simulated photographs: scene, response, exposure, condition, and query.
- `baselines`: constant guesses and oracles.
- `measure`: from photographs to rows of the table.
- `report`: from rows to means, intervals, comparisons, and their report.
- `protocols`: runs P0 to P6.
- `paper_page`: docs/PAPER.md.
"""
