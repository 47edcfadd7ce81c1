"""The network behind `--grounder panoptic`: what it is, how it learns, and how it is written for Rust.

Pictures come from `l4d compose --arrangements` and from built scenes with training seeds. Nothing here may read the
21 scenes of the benchmark.
"""
