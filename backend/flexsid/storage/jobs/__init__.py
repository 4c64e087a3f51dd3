"""Jobs: the queue, leases of those that run, their log, lists and batches."""
