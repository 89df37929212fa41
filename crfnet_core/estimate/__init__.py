"""The method: from photographs to the response of their camera.

facade     `estimate`: a file or an array in, the response out
estimate   the method on one screen: photographs in, response and uncertainty out
analysis   from a photograph to its windows, and from the windows to evidence
options    the choices of an analysis
result     the estimate, and the same as a document for JSON
"""
