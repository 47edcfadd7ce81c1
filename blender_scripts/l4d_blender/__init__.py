"""l4d's Blender half: recipes become multi-view renders with exact depth, instance ids and tracks."""
