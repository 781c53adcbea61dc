"""What is wrong with a package."""


class Failure(Exception):
    """A sentence about it."""


def require(truth, message):
    if not truth:
        raise Failure(message)
