"""Simulated photographs of scene-linear light.

camera        the camera: sensor light, exposure, noise, response, 8 bits, JPEG
development   a camera that develops: what real files went through, in its order
sensor        noise, clipping, mosaic and demosaicing, color matrix
picture       noise reduction, chroma, sharpening, JPEG and scaling of the encoded picture
camera_draws  random cameras that develop, and their shares
resampling    windows of a scene at any angle and scale
augmentation  other light, colors and compositions
unusual       pictures that no response of a camera explains: what an estimate must refuse
photographs   training photographs, made with all of them
demo_plate    the bundled plate of known response
"""
