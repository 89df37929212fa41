"""The photograph network: its shards of statistics, the network itself, the training."""
