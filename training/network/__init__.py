"""The photograph network and its training.

shards               statistics of simulated photographs on disk
features             statistics as the input of the network
conjugate_gradients  the linear solver inside the graph
model                the network
loss                 the estimation error, and the likelihood of the expected error
train                the command that trains
"""
