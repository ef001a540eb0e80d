"""From a seed to cases. All that decides what is planted lies in this folder: a hash of it says whether cases are the same."""
