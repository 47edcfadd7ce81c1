"""What places of a kind share: rooms, tables with a room round them, land under a sky."""
