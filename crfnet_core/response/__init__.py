"""Camera responses.

curve                a strictly monotone response and its inverse
emor                 the empirical model of response: weights to curve, curve to weights
metrics              distances between an estimated and a true response
transfer_functions   sRGB and Rec.709, to compare with
"""
