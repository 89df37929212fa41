"""Whether simulated photographs can be told from real ones: ``python -m training.realism``.

- `__main__`: the command and its table.
- `samples`: photographs, real and simulated, as the network's features of their windows.
- `feature_names`: which features belong to which kind of evidence.
- `classifier`: a classifier between two sets of photographs, cross-validated by scene and by body.
"""
