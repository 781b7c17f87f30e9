"""What a command says when it cannot do what it was asked."""


class Failure(Exception):
    """One sentence for the user; the command ends with status 1."""
