"""Segmenters of l4d in processes of their own; the protocol is described in docs/workers.md."""

__version__ = "0.1.0"
