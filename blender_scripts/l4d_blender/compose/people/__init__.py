"""People of composed scenes: who is cast, what each does on the plan, and the body that does it later."""
