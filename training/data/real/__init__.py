"""Real photographs with measured responses: to measure on; only the responses, never the pixels, are learned from.

- `photographs`: the two folders of photographs as their lists describe them, and the measured responses of every body.
- `file_origin`: the metadata of the original files, and whether they were edited or scaled.
- `stacks`: the stacks that were measured on the camera's own files, and the settings of each body.
"""
