"""Scene recipes: one module per scene, read top to bottom."""
