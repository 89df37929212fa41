"""The method: from photographs to the response of their camera.

estimate   the method on one screen: photographs in, response and uncertainty out
analysis   what the network reads in each photograph
result     the estimate, and the same as a document for JSON
"""
