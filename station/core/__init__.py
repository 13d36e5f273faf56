"""ros_control itself: the standard library and NumPy, nothing else.

```python
from station.core import Controller, ControllerManager, ControlLoop, RobotHW
```

The names are those of `station.core.public`. A name is imported when it is first used,
so that a module that needs only `station.core.errors` imports nothing else.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from station.core import public
    from station.core.public import *  # noqa: F403 - its __all__ decides

    __all__ = public.__all__
else:

    def __getattr__(name: str) -> object:
        """Return a public name, or `__all__`, the list of public names.

        Raises:
            AttributeError: There is no such name.
        """
        from importlib import import_module

        public = import_module("station.core.public")
        if name != "__all__" and name not in public.__all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(public, name)
