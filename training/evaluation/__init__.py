"""Measure models against responses that are known: ``python -m training.evaluation``.

- `__main__`: the command.
- `models`: the models that are measured.
- `test_sets`: scenes and responses, of the data or bundled with the repository.
- `plan`: the simulated photographs: scene, response, exposure, condition, and query.
- `baselines`: constant guesses and oracles.
- `table`: a row for each photograph and estimator, on disk.
- `figures`: the columns of a row.
- `simulated`, `real`, `unusual`: from photographs to rows.
- `bootstrap`, `summary`: from rows to means, intervals, comparisons and reliability.
- `protocols`: runs P0 to P6.
- `report`, `markdown`: report.json and report.md.
- `card`: figures for model.json and the model card.
- `paper`: the figures of the CRF-net paper.
- `cameras`: the worth of a measured response of the same camera.
- `recognition`: how often log footage and limited range are recognized.
"""
