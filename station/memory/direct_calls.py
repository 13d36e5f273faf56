"""Direct calls of functions that stand in the place of methods."""

from collections.abc import Callable


def call_directly(
    owner: object, base: type, **functions: Callable[..., object]
) -> None:
    """Let an object call functions with no method of Python around each.

    A method that a subclass replaces is called as it is.

    Args:
        owner: The object.
        base: The class whose methods only pass their arguments on to the functions.
        functions: The function that stands in the place of each method, by its name.
    """
    for name, function in functions.items():
        if getattr(type(owner), name) is getattr(base, name):
            setattr(owner, name, function)
