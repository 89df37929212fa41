"""Camera responses.

curve                a strictly monotone response and its inverse
emor                 the empirical model of response: weights to curve, curve to weights
log_curves           the published curves of log footage, and their names in ACES configs
metrics              distances between an estimated and a true response
transfer_functions   sRGB and Rec.709, to compare with
"""
