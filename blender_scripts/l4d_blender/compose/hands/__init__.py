"""Hands at a table: whose they are, what they reach and move, and which ways their arms need."""
