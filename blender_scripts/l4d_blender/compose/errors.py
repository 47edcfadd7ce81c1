"""What stops a composition: a try of a plan, or a whole draw, of which another may succeed."""


class Rejected(Exception):
    """This draw does not become a scene; the message says why in a few words."""


class NoRoom(Rejected):
    """This try of a plan lacks room, time or a view for something; another try may have it."""
