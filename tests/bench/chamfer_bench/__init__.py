"""Measures chamferd: the paper's Table 1, a camera flight, and Cycles beside it. See bench.py."""
