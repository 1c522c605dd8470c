"""The sensor graph: pose graphs of others, its covariances, its suspects, the experiments of the paper."""
