"""Scenes on disk: the objects with a role, under a name. One YAML file each."""

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

from station.core.errors import SavedSceneError, SavedSceneNotFoundError, StationError
from station.core.geometry.scene import read_object
from station.library.yaml_folder import FileKind, YamlFolder
from station.reports import SavedScene

_KIND = FileKind("scene", "scenes", SavedSceneNotFoundError, SavedSceneError)


class SavedScenes:
    """The scenes in a folder. Any thread.

    Args:
        folder: Where the files are; the user's own folder when None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._files = YamlFolder(_KIND, folder)

    def names(self) -> list[str]:
        """Return the names of all scenes, sorted."""
        return self._files.names()

    def get(self, name: str) -> SavedScene:
        """Return a scene.

        Raises:
            SavedSceneNotFoundError: There is no scene of that name.
            SavedSceneError: Its file cannot be read or is malformed.
        """
        data = self._files.read(name)
        objects = data.get("objects")
        if not isinstance(objects, list):
            raise self._files.unusable(name, "it has no list 'objects'")
        try:
            for number, entry in enumerate(objects):
                read_object(entry, f"objects/{number}")
        except StationError as error:
            raise self._files.unusable(name, error.message.rstrip(".")) from error
        return SavedScene(name, str(data.get("saved_at", "")), objects)

    def save(self, name: str, objects: Sequence[Mapping[str, object]]) -> SavedScene:
        """Save objects as `scene/objects` has them; a scene of that name is replaced.

        Raises:
            SavedSceneNotFoundError: The name is none.
            SavedSceneError: The file cannot be written.
        """
        now = datetime.now(UTC).isoformat(timespec="seconds")
        entries = [dict(one) for one in objects]
        with self._files.changing(name):
            self._files.write(name, {"saved_at": now, "objects": entries})
        return SavedScene(name, now, entries)

    def delete(self, name: str) -> SavedScene:
        """Delete a scene and return it.

        Raises:
            SavedSceneNotFoundError: There is no scene of that name.
            SavedSceneError: Its file cannot be read or deleted.
        """
        with self._files.changing(name):
            found = self.get(name)
            self._files.delete(name)
            return found
