"""What runs and writes: commands, plans, renders, files; knows no single kind of thing, place or motion."""
