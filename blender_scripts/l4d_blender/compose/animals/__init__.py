"""Animals of composed scenes and what they play with, planned on the ground before anything is built."""
