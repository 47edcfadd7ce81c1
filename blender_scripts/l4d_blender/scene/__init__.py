"""What a scene is made of: time, cameras, things, keys, where they stand; knows no command, render, file."""
