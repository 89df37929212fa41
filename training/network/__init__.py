"""The photograph network and its training.

shards               statistics of simulated photographs on disk
start                where a run begins: a checkpoint, a model folder, or random weights
features             statistics as the input of the network
model                the network
loss                 how probable the evidence makes the true response, and how far the mean answer is from it
train                the command that trains
average              the mean of the weights of several runs
"""
