"""LUT files, OpenColorIO configs and linear plates from an estimated camera response."""
