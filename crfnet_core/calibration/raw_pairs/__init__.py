"""Measure a camera's response from raw files and the JPEGs that the camera made of them; needs rawpy and SciPy."""
