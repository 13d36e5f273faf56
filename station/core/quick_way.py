"""A check that a quicker implementation still returns what the slow one does.

A controller may offer a quicker way than its method `update`, an arm than `read_once`.
A subclass, or a test, that replaces one of these expects to be called in every cycle,
and knows nothing of the quicker way of the class that it extends.
"""


def is_in_force(thing: object, quick: str, *plain: str) -> bool:
    """Return whether none of some methods was replaced without their quicker way.

    Args:
        thing: The object.
        quick: Name of the method that returns the quicker way.
        plain: Names of the methods that it stands for.
    """
    own: dict[str, object] = getattr(thing, "__dict__", {})
    if any(name in own for name in plain):
        return False
    order = type(thing).__mro__
    places = {
        name: next(i for i, kind in enumerate(order) if name in vars(kind))
        for name in (quick, *plain)
    }
    return all(places[quick] <= places[name] for name in plain)
