"""From a training run to a model folder: model.onnx, model.json, run.json and the model card.

model_folder  the command that writes the folder, and golden predictions that onnxruntime must repeat
onnx_graph    the graph, its matrices in half precision
cameras       the command that writes the library of measured cameras
model_card    the command that adds measured figures and writes the card
"""
