"""Measure models against responses that are known: ``python -m training.evaluation``.

- `__main__`: the command.
- `settings`: what is asked for: models, protocols, numbers of photographs.
- `test_sets`: scenes and responses, of the data or bundled with the repository.
- `plan`: which photographs are simulated: scene, response, exposure, condition, and the query about each.
- `baselines`: what stands beside the models: constant guesses and oracles.
- `measure`: photographs to figures, kept on disk.
- `summaries`: figures to means, intervals, comparisons and reliability.
- `report`: the report's dataclasses, and how they are written.
- `protocols`: runs P0 to P6 and writes the report.
- `cameras`: what stored cameras are worth.
- `recognition`: how often log footage and other unusual pictures are recognised.
- `gamma_level`: why gamma 2.2 linearises our photographs worse than the paper's.
"""
