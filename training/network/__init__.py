"""The photograph network and its training.

shards               statistics of simulated photographs on disk
features             statistics as the input of the network
conjugate_gradients  the linear solver inside the graph
model                the network
loss                 the estimation error, and the likelihood of the expected error
moving_average       the average of the weights, which a run yields
train                the command that trains
average              the mean of the weights of several runs
"""
