"""`python -m l4d_blender`: the worker that the l4d binary starts."""

from .worker.cli import main

main()
