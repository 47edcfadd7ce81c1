"""Bodies that act: each module animates one kind of body and records what it does as events."""
