"""Photographs made of scene-linear light: the camera, the scenes seen by it, the demo's plate."""
