"""What perception cannot do without, and may not see."""


class NotSeenError(ValueError):
    """The cameras do not see the table or the front of a drawer, which are always there."""
