"""Real photographs with measured responses: to measure on; only the responses, never the pixels, are learned from.

- `photographs`: the two folders of photographs and what their lists say of them.
- `case_metadata`: what their lists say of the original files.
- `file_origin`: whether a file was edited or scaled after the camera wrote it.
- `bodies`: the measured responses of every body.
- `stacks`: the stacks that were measured on the camera's own files, and the settings of each body.
"""
