"""What policies that look at sets of instances share: batches of sets, what rows tell of dishes."""
