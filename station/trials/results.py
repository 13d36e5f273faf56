"""Keep the results of an experiment in an SQLite file, one row per ended trial."""

import json
import os
import re
import sqlite3
import time
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import Self

from station.core.errors import show, suggest
from station.core.user_files import (
    is_locked,
    make_private_folder,
    open_regular,
    try_lock,
    user_folder,
)
from station.trials.errors import ExperimentError, ExperimentNotFoundError
from station.trials.trace import Trace
from station.trials.trial import Setup, State, Trial, TrialResult, canonical

_SUFFIX = ".sqlite"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")
_REMEDY = "Choose another --name, or another folder with XDG_DATA_HOME."
_FORMAT = 1
"""Version of the tables."""
_TABLES = """
CREATE TABLE about (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE trials (
    number INTEGER PRIMARY KEY,
    hash TEXT NOT NULL UNIQUE,
    trial TEXT NOT NULL,
    state TEXT NOT NULL,
    reason TEXT,
    metrics TEXT NOT NULL,
    seconds REAL NOT NULL,
    worker TEXT NOT NULL,
    ended REAL NOT NULL
);
CREATE TABLE recordings (hash TEXT PRIMARY KEY, trace BLOB NOT NULL) WITHOUT ROWID;
"""


@dataclass(frozen=True, slots=True)
class Row:
    """A trial that has ended.

    Attributes:
        number: Its number in the order of ending, from 1.
        parameters: Its parameters.
        seed: Its seed.
        result: Result of the trial.
    """

    number: int
    parameters: Mapping[str, float]
    seed: int
    result: TrialResult


def default_folder() -> Path:
    """Return the folder of this user's experiments."""
    return user_folder("experiments")


def names(folder: Path | None = None) -> list[str]:
    """Return the names of all experiments in a folder, by default the user's own."""
    found = (folder or default_folder()).glob(f"*{_SUFFIX}")
    return sorted(p.stem for p in found if _NAME.fullmatch(p.stem) and p.is_file())


def name_of_now(kind: str) -> str:
    """Return a name for an experiment without one, of its kind and the time in UTC.

    The name has microseconds, because two experiments that begin in the same second
    must not share a file.
    """
    return f"{kind}-{datetime.now(UTC):%Y%m%d-%H%M%S-%f}"


def file_of(name: str, folder: Path | None = None) -> Path:
    """Return the file of an experiment.

    Raises:
        ExperimentNotFoundError: The name is not allowed for an experiment.
    """
    if not _NAME.fullmatch(name):
        raise ExperimentNotFoundError(
            f"{show(name)} is no name of an experiment.",
            remedy="Use letters, digits, '_', '.' and '-', 100 at most.",
        )
    return (folder or default_folder()) / f"{name}{_SUFFIX}"


def is_written(path: Path) -> bool:
    """Return whether a process of any station runs the experiment of a file."""
    return is_locked(_lock_of(path))


def _lock_of(path: Path) -> Path:
    # A separate file: closing another descriptor of the database's file would release
    # SQLite's locks.
    return path.with_suffix(".lock")


class Results:
    """The file of one experiment. One process writes it, every process may read it.

    Every row is a transaction of its own, so a process that is killed loses only the
    trials that have not ended.

    Use `create` or `open`.

    Attributes:
        path: The file.
        kind: Kind of experiment: `sweep`, `robustness`, `tune` …
        setup: The configuration that all trials share.
        plan: Further settings with which the experiment was started, as plain data.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._connection = connection
        about = dict(connection.execute("SELECT key, value FROM about"))
        self.kind = about["kind"]
        self.setup = Setup(about["setup"])
        self.plan: dict[str, object] = json.loads(about["plan"])

    @classmethod
    def create(
        cls, path: Path, kind: str, setup: Setup, plan: Mapping[str, object]
    ) -> Self:
        """Create the file, or go on with the file of the same experiment.

        Args:
            path: The file.
            kind: Kind of experiment.
            setup: The configuration that all trials share.
            plan: Further settings of the experiment, as plain data.

        Raises:
            ExperimentError: The file holds another experiment, or cannot be written.
        """
        if path.exists():
            found = cls.open(path)
            differing = found.differs_in(kind, setup, plan)
            if not differing:
                return found
            found.close()
            raise ExperimentError(
                f"The experiment '{path.stem}' exists, and is another one; it differs "
                f"in {', '.join(differing)}.",
                remedy="Choose another name, or delete its file to begin anew: "
                f"{path}.",
            )
        try:
            make_private_folder(path.parent)
            # Create it under another name first, so that no reader finds a file without
            # tables.
            part = path.with_suffix(f".{os.getpid()}.part")
            part.unlink(missing_ok=True)
            with closing(sqlite3.connect(part)) as connection, connection:
                connection.executescript(_TABLES)
                connection.executemany(
                    "INSERT INTO about VALUES (?, ?)",
                    [
                        ("format", str(_FORMAT)),
                        ("kind", kind),
                        ("setup", setup.text),
                        ("plan", canonical(plan)),
                        ("created", str(time.time())),
                    ],
                )
            part.replace(path)
        except (OSError, sqlite3.Error) as error:
            raise ExperimentError(_unusable(path, error), remedy=_REMEDY) from error
        return cls.open(path)

    @classmethod
    def open(cls, path: Path) -> Self:
        """Open the file of an experiment.

        Raises:
            ExperimentNotFoundError: There is no such file.
            ExperimentError: The file is not that of an experiment.
        """
        if not path.is_file():
            raise ExperimentNotFoundError(
                f"There is no experiment '{path.stem}'.",
                remedy=suggest(path.stem, names(path.parent)),
            )
        connection = sqlite3.connect(path, timeout=30.0)
        try:
            return cls(path, connection)
        except (sqlite3.Error, KeyError, ValueError) as error:
            connection.close()
            raise ExperimentError(_unusable(path, error), remedy=_REMEDY) from error

    def differs_in(
        self, kind: str, setup: Setup, plan: Mapping[str, object]
    ) -> list[str]:
        """Return the settings in which a new start differs from this experiment."""
        mine = {**self.plan, "kind": self.kind, "configuration": self.setup.text}
        other = {**plan, "kind": kind, "configuration": setup.text}
        return [
            name
            for name in sorted({*mine, *other})
            if canonical(mine.get(name)) != canonical(other.get(name))
        ]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    @contextmanager
    def running(self) -> Iterator[None]:
        """Keep the experiment from other runs and from deletion in a `with` body.

        Raises:
            ExperimentError: Another process runs the experiment.
        """
        lock = _locked(self.path)
        try:
            yield
        finally:
            os.close(lock)

    def delete(self) -> None:
        """Close the file and delete it.

        Raises:
            ExperimentError: A process writes the file, or the file cannot be deleted.
        """
        self.close()
        lock = _locked(self.path)
        try:
            self.path.unlink(missing_ok=True)
            _lock_of(self.path).unlink(missing_ok=True)
        except OSError as error:
            raise ExperimentError(
                _unusable(self.path, error), remedy="See who may write there."
            ) from error
        finally:
            os.close(lock)

    def add(self, trial: Trial, result: TrialResult) -> bool:
        """Keep the result of a trial; return whether the trial is new.

        Raises:
            ExperimentError: The file cannot be written; the rows in it stay sound.
        """
        return self.add_all([(trial, result)])[0]

    def add_all(self, ended: Iterable[tuple[Trial, TrialResult]]) -> list[bool]:
        """Keep the results of several trials, all or none.

        Returns:
            For each trial, whether it is new.

        Raises:
            ExperimentError: The file cannot be written; the rows in it stay sound.
        """
        with self._writing():
            return [self._insert(trial, result) for trial, result in ended]

    def _insert(self, trial: Trial, result: TrialResult) -> bool:
        done = self._connection.execute(
            "INSERT OR IGNORE INTO trials (hash, trial, state, reason, metrics, "
            "seconds, worker, ended) VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
            (
                *(result.hash, trial.to_json(), result.state, result.reason),
                canonical(dict(result.metrics)),
                *(result.seconds, result.worker, time.time()),
            ),
        )
        return done.rowcount == 1

    def set_outcome(self, state: str, reason: str = "") -> None:
        """Note the state of the experiment.

        Args:
            state: `running`, `done`, `cancelled` or `failed`.
            reason: Why it ended; empty without a reason.

        Raises:
            ExperimentError: The file cannot be written.
        """
        with self._writing():
            self._connection.execute(
                "INSERT OR REPLACE INTO about VALUES ('outcome', ?)",
                (canonical({"state": state, "reason": reason}),),
            )

    def outcome(self) -> tuple[str, str]:
        """Return the last noted state, and its reason; both may be empty."""
        found = dict(self._connection.execute("SELECT key, value FROM about"))
        noted = json.loads(found.get("outcome", "{}"))
        return noted.get("state", ""), noted.get("reason", "")

    def created(self) -> float:
        """Return the time at which the file was made [s since 1970]."""
        query = "SELECT value FROM about WHERE key = 'created'"
        (text,) = self._connection.execute(query).fetchone()
        return float(text)

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Make the writes of the body one transaction.

        Raises:
            ExperimentError: The file cannot be written.
        """
        try:
            with self._connection:
                yield
        except sqlite3.Error as error:
            raise ExperimentError(
                f"Nothing more can be kept in {self.path}: {error}.",
                remedy="What has ended is kept. Make room on the disk, then repeat the "
                "command with the same name to go on.",
            ) from error

    def rows(self) -> list[Row]:
        """Return all trials that have ended, in the order of ending."""
        return list(self._rows("", ()))

    def rows_after(self, number: int, count: int) -> list[Row]:
        """Return `count` trials after a number, in the order of ending."""
        where = "WHERE number > ?"
        return list(islice(self._rows(where, (number,)), count))

    def find(self, trial_hash: str) -> TrialResult | None:
        """Return the result of a trial; None if it has not ended."""
        found = next(self._rows("WHERE hash = ?", (trial_hash,)), None)
        return None if found is None else found.result

    def trial(self, trial_hash: str) -> Trial:
        """Return a trial by its hash, or by the first characters of the hash.

        Raises:
            ExperimentNotFoundError: No trial, or more than one, has a hash that begins
                so.
        """
        found = self._connection.execute(
            "SELECT trial FROM trials WHERE substr(hash, 1, ?) = ? LIMIT 2",
            (len(trial_hash), trial_hash),
        ).fetchall()
        if len(found) != 1:
            several = "more than one trial" if found else "no trial"
            raise ExperimentNotFoundError(
                f"The experiment '{self.path.stem}' has {several} '{trial_hash}'.",
                remedy="`station experiments show NAME --json` has all hashes.",
            )
        return Trial.from_json(self.setup, found[0][0])

    def count(self, state: State | None = None) -> int:
        """Return the number of ended trials, or of those in one state."""
        query = "SELECT COUNT(*) FROM trials WHERE ? IS NULL OR state = ?"
        (count,) = self._connection.execute(query, (state, state)).fetchone()
        return int(count)

    def keep_recording(self, trial_hash: str, trace: Trace) -> None:
        """Save every cycle of a trial.

        Raises:
            ExperimentError: The file cannot be written; the rows in it stay sound.
        """
        with self._writing():
            self._connection.execute(
                "INSERT OR REPLACE INTO recordings VALUES (?, ?)",
                (trial_hash, trace.to_bytes()),
            )

    def drop_recordings(self, keep: Collection[str]) -> None:
        """Delete the recordings of all trials that are not in `keep`.

        Raises:
            ExperimentError: The file cannot be written.
        """
        with self._writing():
            marks = ", ".join("?" * len(keep))
            self._connection.execute(
                f"DELETE FROM recordings WHERE hash NOT IN ({marks})",
                tuple(keep),
            )

    def recordings(self) -> dict[str, Trace]:
        """Return the recordings by the hashes of their trials."""
        found = self._connection.execute("SELECT hash, trace FROM recordings")
        return {name: Trace.from_bytes(data) for name, data in found}

    def _rows(self, where: str, values: Sequence[str | int]) -> Iterator[Row]:
        query = (
            "SELECT number, hash, trial, state, reason, metrics, seconds, worker "
            f"FROM trials {where} ORDER BY number"
        )
        for (
            number,
            name,
            text,
            state,
            reason,
            metrics,
            seconds,
            worker,
        ) in self._connection.execute(query, values):
            data = json.loads(text)
            known: State = "done" if state == "done" else "failed"
            yield Row(
                number,
                data["parameters"],
                data["seed"],
                TrialResult(name, known, reason, json.loads(metrics), seconds, worker),
            )


def _locked(path: Path) -> int:
    """Return a descriptor that keeps other processes from writing a file.

    Raises:
        ExperimentError: Another process writes the file, or the folder cannot be used.
    """
    try:
        flags = os.O_CREAT | os.O_RDWR | os.O_NOFOLLOW
        descriptor = open_regular(_lock_of(path), flags)
    except OSError as error:
        raise ExperimentError(_unusable(path, error), remedy=_REMEDY) from error
    if try_lock(descriptor):
        return descriptor
    os.close(descriptor)
    raise ExperimentError(
        f"The experiment '{path.stem}' runs in another process.",
        remedy="Wait for its end, or choose another name.",
        details={"experiment": path.stem},
    )


def _unusable(path: Path, why: object) -> str:
    return f"The file of the experiment {path} cannot be used: {why}."
