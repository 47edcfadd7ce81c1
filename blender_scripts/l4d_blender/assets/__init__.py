"""Procedural assets, one module per kind: functions that return one mesh object standing on its origin."""
