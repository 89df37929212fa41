"""Simulated photographs of scene-linear light.

camera        the camera: sensor light, exposure, noise, response, 8 bits, JPEG
resampling    windows of a scene at any angle and scale
augmentation  other light, colours and compositions
photographs   training photographs, made with all three
unusual       pictures that no response of a camera explains: what an estimate must refuse
demo_plate    the bundled plate of known response
"""
