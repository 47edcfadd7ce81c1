"""Procedural materials, grouped by where they are met: outdoors, interiors, products, skin."""
