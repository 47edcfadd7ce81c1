"""Arrangements: furnished places filled with drawn things and people, for learning what things look like.

Nothing happens in them and nothing is proved of them. Each has its own seed, and is a function of it alone.
"""
