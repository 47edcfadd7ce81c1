"""Scenes without end: a seed draws a place, a cast and what happens, and the same seed draws the same bytes.

`spec` says what is asked for, `places` furnish, `themes` cast and act, `stage` is what both talk to,
`checks` throws away what went wrong, `build` runs them in this order.
"""
